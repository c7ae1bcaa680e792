#include "foreign/test_bench.h"

#include "artifact/artifact.h"
#include "base/timer.h"
#include "foreign/check_artifact.h"
#include "foreign/sample_artifacts.h"
#include "store/manifest.h"

#include <algorithm>
#include <csignal>
#include <poll.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;
constexpr double kLongestSeconds = 600.0;

StageRunResult watch(ChildProcess& child, double signal_after)
{
    constexpr int kPollMilliseconds = 5;
    const Timer timer;
    StageRunResult result;
    bool is_open = true;
    bool is_signalled = false;
    while (true) {
        pollfd ready{is_open ? child.pipe() : -1, POLLIN, 0};
        ::poll(&ready, 1, kPollMilliseconds);
        const auto end = child.poll_end();
        if (is_open) is_open = child.read_available(result.output);
        if (end) {
            result.exit_code = end->exit_code;
            return result;
        }
        if (!is_signalled && timer.seconds() > signal_after) child.signal_group(SIGTERM);
        is_signalled = is_signalled || timer.seconds() > signal_after;
        if (timer.seconds() > kLongestSeconds) child.signal_group(SIGKILL);
    }
}

} // namespace

TestBench::TestBench(StageUnderTest stage, fs::path folder) : stage_(std::move(stage)), folder_(std::move(folder))
{
    clear_out();
}

std::vector<std::string> TestBench::prepare_inputs(const StageDescription& description)
{
    std::vector<std::string> missing;
    for (const auto& port : description.inputs) {
        if (stage_.inputs.contains(port.name)) continue;
        const fs::path sample = place(port.name + ".safetensors");
        if (write_sample(sample, port.schema))
            stage_.inputs[port.name] = sample;
        else if (!port.optional)
            missing.push_back(port.name);
    }
    return missing;
}

std::vector<std::string> TestBench::arguments(const StageDescription& description, const std::string& without) const
{
    std::vector<std::string> arguments;
    for (const auto& port : description.inputs) {
        const auto input = stage_.inputs.find(port.name);
        const bool is_given = input != stage_.inputs.end();
        if (port.name == without || (port.optional && !is_given)) continue;
        const fs::path path = is_given ? input->second : place("absent");
        arguments.insert(arguments.end(), {"--in", port.name + "=" + path.string()});
    }
    for (const auto& port : description.outputs)
        arguments.insert(arguments.end(), {"--out", port.name + "=" + output(port).string()});
    if (description.reads_images)
        arguments.insert(arguments.end(),
                         {"--scan-root", stage_.scan_root.empty() ? folder_.string() : stage_.scan_root.string()});
    return arguments;
}

StageRunResult TestBench::run(const Command& program, const std::vector<std::string>& arguments, Streams streams) const
{
    std::vector<std::string> words = program.arguments;
    words.insert(words.end(), arguments.begin(), arguments.end());
    ChildProcess child(program.program, words, streams);
    return watch(child, kLongestSeconds);
}

StageRunResult TestBench::run_and_terminate(const std::vector<std::string>& arguments, double after_seconds) const
{
    std::vector<std::string> words = stage_.program.arguments;
    words.insert(words.end(), arguments.begin(), arguments.end());
    ChildProcess child(stage_.program.program, words, Streams::Merged);
    return watch(child, after_seconds);
}

fs::path TestBench::output(const PortDescription& port) const
{
    return place("out") / (is_directory_schema(port.schema) ? port.name : port.name + ".safetensors");
}

std::vector<std::string> TestBench::files_in_out() const
{
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(place("out")))
        files.push_back(entry.path().filename().string());
    std::ranges::sort(files);
    return files;
}

void TestBench::clear_out() const
{
    fs::remove_all(place("out"));
    fs::create_directories(place("out"));
}

std::vector<std::string> TestBench::payloads(const StageDescription& description) const
{
    std::vector<std::string> payloads;
    for (const auto& port : description.outputs) {
        if (is_directory_schema(port.schema)) {
            payloads.push_back(folder_digest(output(port), {}));
            continue;
        }
        check_artifact(output(port), port.schema);
        payloads.push_back(read_artifact(output(port)).payload());
    }
    return payloads;
}

} // namespace quoin
