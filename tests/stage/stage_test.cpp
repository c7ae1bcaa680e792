#include "build_paths.h"
#include "stage/stage.h"

#include "base/atomic_file.h"
#include "schema/schema.h"
#include "stage/command_line.h"
#include "support/command.h"
#include "support/expect_error.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::run_command;
using test::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::Not;

class StageContract : public ::testing::Test {
protected:
    StageContract()
    {
        TriangleMesh mesh;
        mesh.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        mesh.face = {{0, 1, 2}};
        write_artifact(folder_ / "in.safetensors", to_artifact(mesh));
    }

    CommandResult toy(const std::string& arguments) const
    {
        return run_command("cd " + folder_.path().string() +
                           " && env -u QUOIN_STORE " QUOIN_BINARY_DIR "/bin/toy_stage " + arguments);
    }
    CommandResult toy_run(const std::string& arguments) const
    {
        return toy("--in mesh=in.safetensors --out mesh=out.safetensors " + arguments);
    }
    bool nothing_was_written() const { return std::distance(fs::directory_iterator(folder_.path()), {}) == 1; }

    TemporaryFolder folder_;
};

TEST_F(StageContract, DescribesItself)
{
    const auto result = toy("--describe");
    ASSERT_EQ(result.exit_code, 0);
    const auto json = nlohmann::json::parse(result.output);
    EXPECT_EQ(json["name"], "toy");
    EXPECT_EQ(json["impl_version"], 3);
    EXPECT_EQ(json["inputs"][0]["schema"], "mesh");
    EXPECT_EQ(json["params"][0]["max"], 10.0);
    EXPECT_EQ(json["params"][1]["affects_result"], false);
    EXPECT_EQ(json["params"][2]["choices"].size(), 4u);
    EXPECT_THAT(toy("--help").output, HasSubstr("what every coordinate is multiplied by"));
}

TEST_F(StageContract, RunsAndRecordsProvenance)
{
    ASSERT_EQ(toy_run("--set factor=3 --record record.json").exit_code, 0);
    EXPECT_EQ(read_mesh(folder_ / "out.safetensors").position[1].x(), 3.0f);
    const auto header = read_artifact_header(folder_ / "out.safetensors");
    EXPECT_EQ(header.metadata.at("quoin.stage"), "toy");
    EXPECT_THAT(header.metadata.at("quoin.params"), HasSubstr("\"factor\":3.0"));
    const auto record = nlohmann::json::parse(read_text(folder_ / "record.json"));
    EXPECT_EQ(record["cached"], false);
    EXPECT_EQ(record["outputs"]["mesh"], header.payload);
    EXPECT_GT(record["peak_memory_bytes"], 1000000);
}

TEST_F(StageContract, ServesTheSecondRunFromTheStore)
{
    ASSERT_EQ(toy_run("--store store --record first.json").exit_code, 0);
    fs::remove(folder_ / "out.safetensors");
    ASSERT_EQ(toy_run("--store store --cache only --threads 2 --set sleep=0 --record second.json").exit_code, 0);
    EXPECT_EQ(read_mesh(folder_ / "out.safetensors").position[1].x(), 2.0f);
    const auto second = nlohmann::json::parse(read_text(folder_ / "second.json"));
    EXPECT_EQ(second["cached"], true);
    EXPECT_EQ(second["seconds"], nlohmann::json::parse(read_text(folder_ / "first.json"))["seconds"]);
    EXPECT_EQ(toy_run("--store store --cache only --set factor=5").exit_code, 5);
}

TEST_F(StageContract, TheKeyFollowsResultsNotSpelling)
{
    const auto key = [&](const std::string& arguments) {
        return toy("--in mesh=in.safetensors --key " + arguments).output;
    };
    EXPECT_EQ(key("--set factor=1"), key("--set factor=1.0 --threads 4 --set sleep=3"));
    EXPECT_NE(key("--set factor=1"), key("--set factor=1.5"));
}

TEST_F(StageContract, ReadsParametersFromAFile)
{
    write_atomically(folder_ / "good.yaml", std::string_view("factor: 4\n"));
    ASSERT_EQ(toy_run("--config good.yaml").exit_code, 0);
    EXPECT_EQ(read_mesh(folder_ / "out.safetensors").position[1].x(), 4.0f);
    write_atomically(folder_ / "bad.yaml", std::string_view("factor: 4\nfactr: 5\n"));
    EXPECT_THAT(toy_run("--config bad.yaml").output,
                AllOf(HasSubstr("bad.yaml:2:1"), HasSubstr("did you mean 'factor'")));
    write_atomically(folder_ / "twice.yaml", std::string_view("factor: 4\nfactor: 5\n"));
    EXPECT_THAT(toy_run("--config twice.yaml").output, HasSubstr("twice.yaml:2:1"));
}

TEST_F(StageContract, AWrongCommandLineExitsWith2AndOneMessage)
{
    const std::vector<std::pair<std::string, std::string>> wrong = {
        {"--out mesh=o", "input 'mesh' is missing"},
        {"--in mesh=in.safetensors", "no output"},
        {"--in mash=in.safetensors --out mesh=o", "did you mean 'mesh'"},
        {"--in mesh=in.safetensors --out mesh=o --set factr=1", "did you mean 'factor'"},
        {"--in mesh=in.safetensors --out mesh=o --set factor=11", "from 0 to 10"},
        {"--in mesh=in.safetensors --out mesh=o --set factor=nan", "finite number"},
        {"--in mesh=in.safetensors --out mesh=o --set factor=two", "a number"},
        {"--in mesh=in.safetensors --out mesh=o --set failure=perhaps", "one of none, impossible, memory, bug"},
        {"--in mesh=in.safetensors --out mesh=o --memory much", "a size such as 4G"},
        {"--in mesh=in.safetensors --out mesh=o --wings", "--wings"},
        {"--in mesh=in.safetensors --out mesh=o --log-level loud", "expected debug"},
    };
    for (const auto& [arguments, expected] : wrong) {
        const auto result = toy(arguments);
        EXPECT_EQ(result.exit_code, 2) << arguments;
        EXPECT_THAT(result.output, HasSubstr(expected));
        EXPECT_EQ(std::ranges::count(result.output, '\n'), 1) << result.output;
        EXPECT_TRUE(nothing_was_written());
    }
}

TEST_F(StageContract, EveryFailureHasItsExitCodeAndLeavesNothing)
{
    for (const auto& [failure, code] :
         std::vector<std::pair<std::string, int>>{{"impossible", 5}, {"memory", 4}, {"bug", 5}}) {
        const auto result = toy_run("--set failure=" + failure);
        EXPECT_EQ(result.exit_code, code) << result.output;
        EXPECT_EQ(std::ranges::count(result.output, '\n'), 1) << result.output;
        EXPECT_TRUE(nothing_was_written());
    }
    EXPECT_EQ(toy("--in mesh=absent --out mesh=o").exit_code, 3);
    EXPECT_EQ(toy("--in mesh=in.safetensors --out mesh=/proc/o").exit_code, 3);
}

TEST_F(StageContract, AFullDiskIsExitCode4AndNamesTheFile)
{
    const auto result = run_command("cd " + folder_.path().string() +
                                    " && ulimit -f 0 && " QUOIN_BINARY_DIR
                                    "/bin/toy_stage --in mesh=in.safetensors --out mesh=out.safetensors");
    EXPECT_EQ(result.exit_code, 4);
    EXPECT_THAT(result.output, HasSubstr("out.safetensors"));
    EXPECT_TRUE(nothing_was_written());
}

TEST_F(StageContract, AReadOnlyOutputFolderIsExitCode3)
{
    const auto result = toy("--in mesh=in.safetensors --out mesh=/sys/out.safetensors");
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.output, HasSubstr("/sys/out.safetensors"));
}

TEST_F(StageContract, ASignalEndsItWith128PlusNAndNothingHalfWritten)
{
    const auto result =
        toy("--in mesh=in.safetensors --out mesh=out.safetensors --store store --set sleep=30 & "
            "pid=$!; until [ -d '" +
            (folder_ / "store/v1/tmp").string() + "' ]; do sleep 0.05; done; sleep 0.3; kill -TERM $pid; wait $pid");
    EXPECT_EQ(result.exit_code, 143);
    EXPECT_FALSE(fs::exists(folder_ / "out.safetensors"));
    EXPECT_TRUE(fs::is_empty(folder_ / "store/v1/tmp"));
}

TEST_F(StageContract, ShowsProgressAsJsonLines)
{
    const auto result = toy_run("--progress json");
    EXPECT_THAT(result.output, HasSubstr(R"("part":"scaling")"));
    EXPECT_EQ(toy_run("").output, "");
}

TEST(ParseSize, UnderstandsUnits)
{
    EXPECT_EQ(parse_size("500M"), 500ull << 20);
    EXPECT_EQ(parse_size("1.5G"), 3ull << 29);
    EXPECT_EQ(parse_size("0"), 0u);
    EXPECT_THROW(parse_size("4X"), UsageError);
}

} // namespace
} // namespace quoin
