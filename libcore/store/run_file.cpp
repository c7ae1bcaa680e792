#include "store/run_file.h"

#include <algorithm>
#include <ctime>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <random>

namespace quoin {
namespace fs = std::filesystem;
using Json = nlohmann::json;
namespace {

// Sorted by time, as far as the clock is right; unique by its random end.
fs::path new_run_file(const Store& store)
{
    std::random_device device; // names only; no result depends on it
    const std::time_t now = std::time(nullptr);
    const std::string id = fmt::format("{:%Y%m%d-%H%M%S}-{:04x}", fmt::gmtime(now), device() & 0xffffU);
    return store.root() / "runs" / (id + ".jsonl");
}

std::string started_text(const std::string& id) // 20261125-013507-1a2b
{
    if (id.size() < 15) return id;
    return fmt::format("{}-{}-{} {}:{}:{}", id.substr(0, 4), id.substr(4, 2), id.substr(6, 2), id.substr(9, 2),
                       id.substr(11, 2), id.substr(13, 2));
}

Json json_of(const RunTask& task)
{
    Json json = {{"stage", task.stage}, {"state", task.state}, {"seconds", task.seconds}};
    const auto add = [&](const char* name, const auto& value, bool is_said) {
        if (is_said) json[name] = value;
    };
    add("scan", task.scan, !task.scan.empty());
    add("variant", task.variant, !task.variant.empty());
    add("key", task.key, !task.key.empty());
    add("outputs", task.outputs, !task.outputs.empty());
    add("peak_memory_bytes", task.peak_memory, task.peak_memory > 0);
    add("exit_code", task.exit_code, task.exit_code != 0);
    add("words", task.words, !task.words.empty());
    return json;
}

RunTask task_of(const Json& json)
{
    RunTask task;
    task.stage = json.value("stage", "");
    task.scan = json.value("scan", "");
    task.variant = json.value("variant", "");
    task.state = json.value("state", "");
    task.key = json.value("key", "");
    task.outputs = json.value("outputs", task.outputs);
    task.seconds = json.value("seconds", 0.0);
    task.peak_memory = json.value("peak_memory_bytes", std::uint64_t{0});
    task.exit_code = json.value("exit_code", 0);
    task.words = json.value("words", task.words);
    return task;
}

void take_line(RunHistory& run, const std::string& line)
{
    const Json json = Json::parse(line, nullptr, false);
    if (!json.is_object()) return;
    try {
        if (json.contains("pipeline")) {
            run.pipeline = json.value("pipeline", "");
        } else if (json.contains("stage")) {
            run.tasks.push_back(task_of(json));
        } else if (json.contains("exit_code")) {
            run.exit_code = json.value("exit_code", 0);
            run.seconds = json.value("seconds", 0.0);
        }
    } catch (const Json::exception&) { // of another type than ours
    }
}

} // namespace

RunFile::RunFile(const Store& store, const std::string& pipeline) : file_(new_run_file(store), HeldFile::End::Keep)
{
    file_.add_line(Json{{"pipeline", pipeline}}.dump());
}

void RunFile::add(const RunTask& task)
{
    file_.add_line(json_of(task).dump(-1, ' ', false, Json::error_handler_t::replace));
}

void RunFile::end(int exit_code, double seconds)
{
    file_.add_line(Json{{"exit_code", exit_code}, {"seconds", seconds}}.dump());
}

std::vector<fs::path> run_files(const Store& store)
{
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(store.root() / "runs", error))
        if (entry.path().extension() == ".jsonl") files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
}

RunHistory read_run_file(const fs::path& file)
{
    RunHistory run;
    run.id = file.stem().string();
    run.started = started_text(run.id);
    run.holder = holder_text(file);
    run.is_running = is_held(file);
    for (const auto& line : lines_of(file))
        take_line(run, line);
    return run;
}

std::set<std::string> names_in(const RunHistory& run)
{
    std::set<std::string> names;
    for (const auto& task : run.tasks) {
        if (!task.key.empty()) names.insert(task.key);
        for (const auto& [port, payload] : task.outputs)
            names.insert(payload);
    }
    return names;
}

} // namespace quoin
