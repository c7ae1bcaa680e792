// Small programs that honour the stage contract, written into a temporary folder, for tests of what runs them.
#pragma once

#include "support/temporary_folder.h"

#include <filesystem>
#include <string>
#include <vector>

namespace quoin::test {

struct FakeStage {
    std::string name;
    std::vector<std::string> inputs; // ports; "?port" is optional, "port:schema/2" names schema and version
    std::vector<std::string> outputs;
    std::string body = {}; // shell commands run before the outputs are written
};

// The samples of its outputs are $here/STAGE.PORT.artifact. Every fake stage has the parameters size (float, 0 to 1 m),
// count (int), mode (fast or exact) and flag (bool). It appends "start NAME" and "end NAME" to log() and writes the
// arguments that it got to arguments(NAME).
class FakeStages {
public:
    explicit FakeStages(const std::vector<FakeStage>& stages);

    const std::filesystem::path& folder() const { return folder_.path(); }
    std::vector<std::string> log() const;
    std::string arguments(const std::string& name) const;

private:
    TemporaryFolder folder_;
};

} // namespace quoin::test
