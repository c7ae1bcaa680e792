#include "foreign/stage_check.h"

#include "artifact/artifact.h"
#include "artifact/digest.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "foreign/variations.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;
using Json = nlohmann::json;

// A check that does not hold; the message says why.
struct CheckFailure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

void require(bool holds, const std::string& otherwise)
{
    if (!holds) throw CheckFailure(otherwise);
}

std::string last_line(std::string text)
{
    while (text.ends_with('\n'))
        text.pop_back();
    return text.substr(text.rfind('\n') + 1);
}

class StageCheck {
public:
    explicit StageCheck(TestBench& bench) : bench_(bench) {}

    std::vector<CheckResult> run()
    {
        check("describes itself", [&] { describe(); });
        if (results_.back().state == CheckResult::State::Failed) return results_;
        missing_ = bench_.prepare_inputs(stage_);
        refusals();
        results_of_runs();
        keys_and_store();
        return results_;
    }

private:
    void check(const std::string& name, const std::function<void()>& body)
    {
        CheckResult result{name, CheckResult::State::Passed, ""};
        try {
            body();
        } catch (const CheckFailure& failure) {
            result = {name, CheckResult::State::Failed, failure.what()};
        } catch (const Error& error) {
            result = {name, CheckResult::State::Failed, error.what()};
        }
        results_.push_back(result);
    }

    // A check that needs every required input.
    void check_run(const std::string& name, const std::function<void()>& body)
    {
        if (missing_.empty()) return check(name, body);
        results_.push_back(
            {name, CheckResult::State::Skipped,
             fmt::format("there is no sample of its input: give --in {}=FILE", fmt::join(missing_, "=FILE --in "))});
    }

    void describe()
    {
        const auto first = bench_.run(bench_.stage().program, {"--describe"}, Streams::OutputOnly);
        require(first.exit_code == 0, fmt::format("--describe ended with exit code {}", first.exit_code));
        stage_ = parse_description(first.output, "--describe");
        require(!stage_.outputs.empty(), "it has no outputs");
        require(stage_.impl_version >= 1, "impl_version is expected to be 1 or more");
        for (const auto& spec : stage_.params) {
            require(!spec.doc.empty(), fmt::format("parameter '{}' has no sentence (doc)", spec.name));
            parse_param(spec, format_param(spec.default_value), "its default");
        }
        const auto second = bench_.run(bench_.stage().program, {"--describe"}, Streams::OutputOnly);
        require(first.output == second.output, "--describe said two different things");
    }

    // Runs with `more` words, which must be refused with `code`, one message that has `expected`, and nothing written.
    void require_refusal(const Words& arguments, int code, const std::string& expected)
    {
        const auto result = bench_.run(bench_.stage().program, arguments);
        const std::string tail = arguments.empty() ? "" : arguments.back();
        require(result.exit_code == code, fmt::format("'{}' ended with exit code {} instead of {}: {}", tail,
                                                      result.exit_code, code, last_line(result.output)));
        constexpr std::ptrdiff_t kLines = 4; // a message, not a stack trace
        require(!result.output.empty(), fmt::format("'{}' was refused without a word", tail));
        require(std::ranges::count(result.output, '\n') <= kLines,
                fmt::format("'{}' was refused in {} lines; one message is enough", tail,
                            std::ranges::count(result.output, '\n')));
        require(result.output.find(expected) != std::string::npos,
                fmt::format("'{}': the message does not name '{}': {}", tail, expected, last_line(result.output)));
        const auto left = bench_.files_in_out();
        require(left.empty(), fmt::format("'{}' left {} behind", tail, fmt::join(left, ", ")));
    }

    Words with(const Words& more) const
    {
        Words words = bench_.arguments(stage_);
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }

    void refusals()
    {
        check("refuses an unknown parameter and names the nearest", [&] {
            const std::string near = stage_.params.empty() ? "" : stage_.params.front().name;
            require_refusal(with({"--set", misspelt(near, stage_.params) + "=1"}), 2, near);
        });
        check("refuses values of the wrong type", [&] {
            for (const auto& spec : stage_.params)
                if (spec.type != ParamType::String)
                    require_refusal(with({"--set", spec.name + "=@wrong"}), 2, spec.name);
        });
        check("refuses values out of range", [&] {
            for (const auto& spec : stage_.params)
                for (const auto& text : texts_out_of_range(spec))
                    require_refusal(with({"--set", spec.name + "=" + text}), 2, spec.name);
        });
        check("refuses an unknown port", [&] {
            require_refusal(with({"--in", "no_such_port=x"}), 2, "no_such_port");
            require_refusal(with({"--out", "no_such_port=x"}), 2, "no_such_port");
        });
        check("refuses an unknown option", [&] {
            require_refusal(with({"--no-such-option", "1"}), 2, "no-such-option");
        });
        for (const auto& port : stage_.inputs)
            if (!port.optional)
                check(fmt::format("asks for the input '{}'", port.name),
                      [&] { require_refusal(bench_.arguments(stage_, port.name), 2, port.name); });
        bad_inputs();
    }

    void bad_inputs()
    {
        for (const auto& port : stage_.inputs) {
            if (port.optional || is_directory_schema(port.schema)) continue;
            check_run(fmt::format("refuses a missing, damaged or other '{}'", port.name), [&] {
                const fs::path whole = bench_.stage().inputs.at(port.name);
                write_half(whole, bench_.place("half.safetensors"));
                write_atomically(bench_.place("text.safetensors"), std::string_view("this is no artifact"));
                const Artifact other{"something_else", 1, {}, {}};
                write_artifact(bench_.place("other.safetensors"), other);
                for (const char* name : {"absent", "half.safetensors", "text.safetensors", "other.safetensors"}) {
                    Words words = bench_.arguments(stage_, port.name);
                    words.insert(words.end(), {"--in", port.name + "=" + bench_.place(name).string()});
                    require_refusal(words, 3, name);
                }
            });
        }
    }

    static void write_half(const fs::path& whole, const fs::path& place)
    {
        const std::string bytes = read_text(whole);
        write_atomically(place, std::string_view(bytes).substr(0, bytes.size() / 2));
    }

    // Payloads of a run that must succeed.
    Words payloads_of(const Command& program, const Words& arguments)
    {
        bench_.clear_out();
        const auto result = bench_.run(program, arguments);
        require(result.exit_code == 0, fmt::format("exit code {}: {}", result.exit_code, last_line(result.output)));
        return bench_.payloads(stage_);
    }

    void results_of_runs()
    {
        const Command& program = bench_.stage().program;
        Words expected;
        check_run("computes whole outputs of their schemas", [&] {
            expected = payloads_of(program, with({}));
            require(bench_.files_in_out().size() == stage_.outputs.size(), "it left other files beside its outputs");
        });
        check_run("gives the same bytes again, and in any order of arguments", [&] {
            require(payloads_of(program, with({})) == expected, "a second run gave other bytes");
            require(payloads_of(program, reordered(with({}))) == expected,
                    "another order of arguments gave other bytes");
        });
        check_run("gives the same bytes for 1, 2 and 4 threads", [&] {
            for (const char* threads : {"1", "2", "4"})
                require(payloads_of(program, with({"--threads", threads})) == expected,
                        fmt::format("{} threads gave other bytes", threads));
        });
        check_run("takes the options of every stage", [&] {
            require(payloads_of(program, with({"--progress", "none", "--log-level", "error", "--memory", "8G",
                                               "--cache", "off"})) == expected,
                    "they changed the bytes");
        });
        check_run("leaves nothing half-written when it is ended", [&] { end_early(); });
    }

    void end_early()
    {
        for (const double seconds : {0.0, 0.02, 0.1}) {
            bench_.clear_out();
            const auto result = bench_.run_and_terminate(with({}), seconds);
            constexpr int kTerminated = 128 + 15;
            require(result.exit_code == 0 || result.exit_code == kTerminated || result.exit_code == 75,
                    fmt::format("SIGTERM ended it with exit code {}; expected 143, or 75", result.exit_code));
            if (result.exit_code == 0) continue; // it was quicker
            for (const auto& port : stage_.outputs)
                if (fs::exists(bench_.output(port))) bench_.payloads(stage_); // whole, then
        }
    }

    // Key and JSON as `--key` prints them.
    std::string key_of(const Words& more)
    {
        Words words = with(more);
        words.emplace_back("--key");
        const auto result = bench_.run(bench_.stage().managed, words, Streams::OutputOnly);
        require(result.exit_code == 0, fmt::format("--key ended with exit code {}", result.exit_code));
        return result.output;
    }

    void keys_and_store()
    {
        check_run("has a key that is the digest of its JSON", [&] {
            const std::string text = key_of({});
            const std::size_t line = text.find('\n');
            const std::string json =
                line == std::string::npos ? "" : text.substr(line + 1, text.rfind('\n') - line - 1);
            require(Json::accept(json) && sha256_hex(json) == text.substr(0, line),
                    "the first line is not the SHA-256 of the second");
        });
        check_run("has one key for one result: any order, threads, spelled defaults", [&] {
            const std::string key = key_of({});
            require(key_of({"--threads", "3", "--progress", "none"}) == key, "--threads changed it");
            for (const auto& spec : stage_.params)
                require(key_of({"--set", spec.name + "=" + format_param(spec.default_value)}) == key,
                        fmt::format("the default of '{}', spelled out, changed it", spec.name));
        });
        check_run("has another key for another parameter, if it affects the result", [&] {
            const std::string key = key_of({});
            for (const auto& spec : stage_.params)
                if (const auto other = other_value(spec))
                    require((key_of({"--set", spec.name + "=" + *other}) != key) == spec.flags.affects_result,
                            fmt::format("'{}' {} the key", spec.name,
                                        spec.flags.affects_result ? "did not change" : "changed"));
        });
        check_run("fills the store and is served from it", [&] { use_store(); });
    }

    void use_store()
    {
        const Command& managed = bench_.stage().managed;
        const std::string store = bench_.place("store").string();
        const std::string record = bench_.place("record.json").string();
        const Words computed = payloads_of(managed, with({"--store", store, "--record", record}));
        require(payloads_of(managed, with({"--store", store, "--record", record, "--cache", "only"})) == computed,
                "the store gave other bytes");
        const Json json = Json::parse(read_text(record), nullptr, false);
        require(json.is_object() && json.value("cached", false),
                "the record does not say that it was found in the store");
        for (std::size_t i = 0; i < stage_.outputs.size(); ++i)
            require(json["outputs"].value(stage_.outputs[i].name, "") == computed[i],
                    "the record names another payload");
        const auto refused = bench_.run(managed, with({"--store", bench_.place("empty").string(), "--cache", "only"}));
        require(refused.exit_code == 5,
                fmt::format("--cache only on an empty store ended with exit code {} instead of 5", refused.exit_code));
    }

    TestBench& bench_;
    StageDescription stage_;
    Words missing_; // required inputs that there is no sample of
    std::vector<CheckResult> results_;
};

} // namespace

std::vector<CheckResult> check_stage(const StageUnderTest& stage)
{
    const TemporaryPath folder(fs::temp_directory_path() / "quoin-stage-check");
    fs::create_directory(folder.path());
    TestBench bench(stage, folder.path());
    return StageCheck(bench).run();
}

} // namespace quoin
