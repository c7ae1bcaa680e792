// Every file of bad/ is refused with exactly the words that stand beside it, and nothing is started. A file
// NAME.arguments is the command line where it is not `run NAME.yaml --scan ROOM`.
#include "build_paths.h"
#include "pipeline/fake_stages.h"
#include "support/command.h"
#include "support/file_text.h"

#include <fstream>
#include <gmock/gmock.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = QUOIN_SOURCE_DIR "/tests/pipeline/bad";

std::vector<std::string> names()
{
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(kFolder))
        if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem());
    std::ranges::sort(names);
    return names;
}

std::string with(std::string text, const std::string& word, const std::string& replacement)
{
    for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + replacement.size()))
        text.replace(at, word.size(), replacement);
    return text;
}

class BadPipeline : public testing::TestWithParam<std::string> {
protected:
    test::FakeStages stages_{{{"import", {"folder"}, {"scan"}},
                              {"fuse", {"scan"}, {"mesh"}},
                              {"partition", {"mesh"}, {"plane_mesh"}},
                              {"merge", {"plane_mesh"}, {"plane_mesh"}},
                              {"bake", {"scan", "plane_mesh", "?lines"}, {"textured_mesh"}},
                              {"export", {"textured_mesh"}, {"model"}},
                              {"newer", {"mesh:mesh/2"}, {"mesh:mesh/2"}},
                              {"newest", {"mesh:mesh/3"}, {"mesh:mesh/3"}}}};
    test::TemporaryFolder room_;
};

TEST_P(BadPipeline, IsRefusedWithTheWordsBesideIt)
{
    const fs::path arguments = kFolder / (GetParam() + ".arguments");
    const std::string line =
        fs::exists(arguments) ? test::file_text(arguments) : "run " + GetParam() + ".yaml --scan ROOM";
    const auto result =
        test::run_command("cd '" + kFolder.string() + "' && QUOIN_STAGES='" + stages_.folder().string() +
                          "' QUOIN_CONFIGS='" + room_.path().string() + "' QUOIN_PIPELINES=. '" +
                          QUOIN_BINARY_DIR "/bin/quoin' " + with(with(line, "\n", ""), "ROOM", room_.path().string()));
    EXPECT_EQ(result.exit_code, 2);
    const std::string said = with(with(result.output, kFolder.string() + "/", ""), room_.path().string(), "ROOM");
    const fs::path expected = kFolder / (GetParam() + ".expected");
    if (std::getenv("QUOIN_WRITE_EXPECTED")) std::ofstream(expected) << said;
    EXPECT_EQ(said, test::file_text(expected));
    EXPECT_TRUE(stages_.log().empty());
    EXPECT_FALSE(fs::exists(kFolder / "out"));
}

INSTANTIATE_TEST_SUITE_P(Each, BadPipeline, testing::ValuesIn(names()),
                         [](const auto& parameter) { return with(parameter.param, "-", "_"); });

} // namespace
} // namespace quoin
