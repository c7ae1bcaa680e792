// A stage on the test bench: a folder with its inputs, and runs of it that are watched.
#pragma once

#include "pipeline/description.h"
#include "pipeline/process.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace quoin {

struct StageRunResult {
    int exit_code = 0;
    std::string output; // stdout and stderr together, or stdout alone
};

// How a stage is called.
struct StageUnderTest {
    Command program; // as its author wrote it
    Command managed; // as pipelines run it: the same for Quoin's own stages, by run-command for foreign ones
    std::map<std::string, std::filesystem::path> inputs; // given by the user; samples stand in for the others
    std::filesystem::path scan_root;
};

class TestBench {
public:
    // `folder` is empty and stays the caller's.
    TestBench(StageUnderTest stage, std::filesystem::path folder);

    const StageUnderTest& stage() const { return stage_; }

    // Inputs for the described ports; the names of the required ones that there is no sample of.
    std::vector<std::string> prepare_inputs(const StageDescription& description);

    // "--in PORT=FILE" for every input but `without`, "--out PORT=out/..." for every output, "--scan-root".
    std::vector<std::string> arguments(const StageDescription& description, const std::string& without = "") const;

    StageRunResult run(const Command& program, const std::vector<std::string>& arguments,
                       Streams streams = Streams::Merged) const;
    StageRunResult run_and_terminate(const std::vector<std::string>& arguments, double after_seconds) const;

    std::filesystem::path place(const std::string& name) const { return folder_ / name; }
    std::filesystem::path output(const PortDescription& port) const;
    std::vector<std::string> files_in_out() const;
    void clear_out() const;

    // Payloads of all outputs, in the order of the ports; throws InputError when one is missing or damaged.
    std::vector<std::string> payloads(const StageDescription& description) const;

private:
    StageUnderTest stage_;
    std::filesystem::path folder_;
};

} // namespace quoin
