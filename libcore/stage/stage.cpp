#include "stage/stage.h"

#include "artifact/container.h"
#include "artifact/digest.h"
#include "base/atomic_file.h"
#include "base/durable_file.h"
#include "base/error.h"
#include "base/fail_point.h"
#include "base/formula.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/timer.h"
#include "stage/command_line.h"
#include "stage/console_progress.h"
#include "stage/describe.h"
#include "stage/signals.h"
#include "store/identity.h"
#include "store/lease.h"
#include "store/manifest.h"
#include "store/store.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <sys/resource.h>

namespace quoin {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// Everything that one run of a stage knows.
struct StageRun::State {
    const Stage& stage;
    const CommandLine& line;
    std::optional<Store> store;
    std::map<std::string, InputIdentity> inputs;
    Key key;
    std::map<std::string, std::string> outputs = {}; // port -> payload, as they are written
    std::map<std::string, std::uint64_t> sizes = {}; // in the store
    std::optional<Lease> lease = {};
    double store_seconds = 0.0; // spent on keys, lookups and publishing
};

namespace {

using State = StageRun::State;

const Port& output_port(const Stage& stage, const std::string& name)
{
    const auto it = std::ranges::find(stage.outputs, name, &Port::name);
    if (it == stage.outputs.end()) throw std::logic_error("stage " + stage.name + " has no output '" + name + "'");
    return *it;
}

Key key_of(const State& state, const std::vector<ParamSpec>& specs)
{
    KeyParts parts;
    parts.stage = state.stage.name;
    parts.implementation = implementation_of(state.stage);
    parts.impl_version = state.stage.impl_version;
    for (const auto& port : state.stage.outputs)
        parts.outputs[port.name] = versioned_schema(port.schema_name());
    parts.params = key_params(specs, state.line.params);
    parts.inputs = state.inputs;
    return make_key(parts);
}

void limit_memory(std::uint64_t bytes)
{
    if (bytes == 0) return;
    const rlimit limit{bytes, bytes};
    ::setrlimit(RLIMIT_DATA, &limit);
}

std::uint64_t peak_memory() // [bytes], of the stage or the largest program that it ran
{
    rusage own{};
    rusage children{};
    ::getrusage(RUSAGE_SELF, &own);
    ::getrusage(RUSAGE_CHILDREN, &children);
    return static_cast<std::uint64_t>(std::max(own.ru_maxrss, children.ru_maxrss)) * 1024;
}

Json record_of(const State& state, double seconds)
{
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    const auto to_seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    Json inputs = Json::object();
    for (const auto& [port, input] : state.inputs)
        inputs[port] = input.payload;
    return {{"stage", state.stage.name},
            {"impl_version", state.stage.impl_version},
            {"key", state.key.hex},
            {"cached", false},
            {"seconds", seconds},
            {"cpu_seconds", to_seconds(usage.ru_utime) + to_seconds(usage.ru_stime)},
            {"peak_memory_bytes", peak_memory()},
            {"threads", thread_count()},
            {"inputs", inputs},
            {"outputs", state.outputs},
            {"params", Json::parse(params_json(state.line.params))}};
}

void write_record(const CommandLine& line, const std::string& record)
{
    if (!line.record.empty()) replace_file(line.record, record);
}

// True when the store had the result and the outputs are in their places.
bool serve_from_store(const State& state)
{
    const auto entry = state.store->find(state.key);
    if (!entry) return false;
    for (const auto& [port, place] : state.line.outputs) {
        const auto payload = entry->outputs.find(port);
        if (payload == entry->outputs.end() || !state.store->link(payload->second, place)) return false;
    }
    write_record(state.line, served_record(*entry, state.key));
    return true;
}

// An input that cannot be read may be damaged in the store: then it is taken out, and whoever makes it computes it
// anew.
void call_body(State& state, const StageBody& body)
{
    try {
        body(StageRun(state), state.line.params);
    } catch (const InputError& error) {
        std::string taken;
        for (const auto& [port, input] : state.inputs)
            if (state.store && state.store->disown_if_damaged(input.payload)) taken += " '" + port + "'";
        if (taken.empty()) throw;
        throw InputError(
            fmt::format("{}; the store's copy of{} was damaged and is gone: make it again", error.what(), taken));
    }
}

void compute(State& state, const StageBody& body)
{
    const Timer timer;
    const ConsoleProgress progress(state.line.progress, state.stage.name);
    call_body(state, body);
    for (const auto& [port, place] : state.line.outputs)
        if (!state.outputs.contains(port))
            throw std::logic_error("stage " + state.stage.name + " did not write '" + port + "'");
    Json record = record_of(state, timer.seconds());
    if (state.store) {
        const Timer publishing;
        state.store->publish(state.key, {state.outputs, record.dump(), state.sizes});
        for (const auto& [port, place] : state.line.outputs)
            state.store->link(state.outputs.at(port), place);
        fail_point("outputs_linked");
        record["store_seconds"] = state.store_seconds + publishing.seconds();
    }
    write_record(state.line, record.dump(2) + "\n");
}

std::vector<std::string> payloads_of(const std::map<std::string, InputIdentity>& inputs)
{
    std::vector<std::string> payloads;
    for (const auto& [port, input] : inputs)
        payloads.push_back(input.payload);
    return payloads;
}

void keep_in_store(State& state, const std::string& port, const fs::path& finished)
{
    const Timer timer;
    const std::string& payload = state.outputs.at(port);
    state.lease->keep(payload);
    state.sizes[port] = state.store->adopt(finished, payload);
    state.store_seconds += timer.seconds();
}

void run(const Stage& stage, const std::vector<ParamSpec>& specs, const CommandLine& line, const StageBody& body)
{
    set_log_level(line.log_level);
    keep_freed_memory();
    set_thread_count(line.threads);
    limit_memory(line.memory);
    State state{stage, line, {}, {}, {}};
    const Timer timer;
    if (line.cache != CacheMode::Off) state.store.emplace(line.store);
    const fs::path stat_cache = state.store ? state.store->stat_cache() : fs::path();
    for (const auto& port : stage.inputs)
        if (const auto it = line.inputs.find(port.name); it != line.inputs.end())
            state.inputs[port.name] = identify_input({port.name, port.schema_name()}, it->second, stat_cache);
    state.key = key_of(state, specs);
    if (line.key) {
        fmt::print("{}\n{}\n", state.key.hex, state.key.json);
        return;
    }
    if (!state.store) return compute(state, body);
    if (serve_from_store(state)) return;
    if (line.cache == CacheMode::Only)
        throw Error(ExitCode::Impossible,
                    fmt::format("{}: the store has no result for this key ({}); run it with --cache auto", stage.name,
                                state.key.hex));
    if (!state.store->is_writable()) {
        log_warning(fmt::format("{}: the store is read-only; the result will not be kept in it", line.store.string()));
        state.store.reset();
        return compute(state, body);
    }
    state.lease.emplace(*state.store, state.key, payloads_of(state.inputs));
    fail_point("lease_taken");
    state.store_seconds = timer.seconds(); // all but waiting for another process is a moment
    if (!serve_from_store(state)) compute(state, body);
}

// What the stage declares for inputs of this size [bytes]; none where that depends on more.
std::optional<double> declared_memory(const Stage& stage, const CommandLine& line)
{
    if (stage.resources.memory.empty()) return std::nullopt;
    const auto bytes = [&](const std::string& port) -> std::optional<double> {
        const auto input = line.inputs.find(port);
        if (input == line.inputs.end()) return 0.0;
        std::error_code error;
        const auto size = fs::file_size(input->second, error);
        return error ? std::nullopt : std::optional(static_cast<double>(size));
    };
    return evaluate_formula(stage.resources.memory,
                            {.bytes = bytes, .value = [](const std::string&) { return std::optional<double>(); }});
}

std::string size_text(double bytes) // as --memory takes it
{
    constexpr double kMega = 1 << 20;
    return fmt::format("{:.0f}M", std::ceil(bytes / kMega));
}

std::string out_of_memory(const Stage& stage, const std::optional<CommandLine>& line)
{
    const bool is_limited = line && line->memory > 0;
    std::string message = "out of memory";
    if (is_limited) message += fmt::format(" with --memory {}", size_text(static_cast<double>(line->memory)));
    if (const auto need = line ? declared_memory(stage, *line) : std::nullopt)
        message += fmt::format("; inputs of this size take about {}", size_text(*need));
    return message + (is_limited ? "; give it more, or make the input smaller"
                                 : "; run it where more is free, or make the input smaller");
}

int report(const std::string& stage, ExitCode code, const std::string& message)
{
    remove_unfinished_files();
    fmt::print(stderr, "{}: error: {}\n", stage, message);
    return static_cast<int>(code);
}

} // namespace

std::string implementation_of(const Stage& stage)
{
    return stage.implementation.empty() ? "builtin/" + stage.name : stage.implementation;
}

const fs::path& StageRun::in(const std::string& port) const { return state_->line.inputs.at(port); }
bool StageRun::has(const std::string& port) const { return state_->line.inputs.contains(port); }
bool StageRun::wants(const std::string& port) const { return state_->store || state_->line.outputs.contains(port); }
const fs::path& StageRun::scan_root() const { return state_->line.scan_root; }

void StageRun::write_artifact_to(const std::string& port, Artifact artifact) const
{
    output_port(state_->stage, port);
    if (!wants(port)) return;
    Json inputs = Json::object();
    for (const auto& [name, input] : state_->inputs)
        inputs[name] = {{"schema", input.schema}, {"payload", input.payload}};
    artifact.metadata = {{"quoin.key", state_->key.hex},
                         {"quoin.stage", state_->stage.name},
                         {"quoin.impl_version", std::to_string(state_->stage.impl_version)},
                         {"quoin.params", params_json(state_->line.params)},
                         {"quoin.inputs", inputs.dump()}};
    if (!state_->store) {
        state_->outputs[port] = write_artifact(state_->line.outputs.at(port), artifact);
        return;
    }
    const TemporaryPath temporary(state_->store->temporary_place(port));
    state_->outputs[port] = write_artifact_in_place(temporary.path(), artifact, state_->line.store);
    keep_in_store(*state_, port, temporary.path());
}

void StageRun::write_folder(const std::string& port, const std::function<void(const fs::path&)>& fill) const
{
    output_port(state_->stage, port);
    if (!wants(port)) return;
    if (!state_->store) {
        write_folder_atomically(state_->line.outputs.at(port), fill);
        state_->outputs[port] = folder_digest(state_->line.outputs.at(port), {});
        return;
    }
    const TemporaryPath temporary(state_->store->temporary_place(port));
    write_folder_atomically(temporary.path(), fill);
    state_->outputs[port] = folder_digest(temporary.path(), {});
    keep_in_store(*state_, port, temporary.path());
}

int run_stage(const Stage& stage, const std::vector<ParamSpec>& params, int argc, char** argv, const StageBody& body)
{
    std::optional<CommandLine> line;
    try {
        handle_signals();
        line = parse_command_line(stage, params, argc, argv);
        if (line->help)
            fmt::print("{}", help_text(stage, params));
        else if (line->describe)
            fmt::print("{}\n", describe_json(stage, params));
        else
            run(stage, params, *line, body);
        return static_cast<int>(ExitCode::Done);
    } catch (const Error& error) {
        return report(stage.name, error.code(), error.what());
    } catch (const std::bad_alloc&) {
        return report(stage.name, ExitCode::Resources, out_of_memory(stage, line));
    } catch (const fs::filesystem_error& error) {
        const bool full = error.code() == std::errc::no_space_on_device;
        return report(stage.name, full ? ExitCode::Resources : ExitCode::Input, error.what());
    } catch (const std::exception& error) {
        return report(stage.name, ExitCode::Impossible,
                      fmt::format("internal error: {}; please report it with this command line", error.what()));
    }
}

} // namespace quoin
