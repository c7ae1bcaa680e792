// Programs that are not Quoin's own in a pipeline: described command lines, programs of the contract, and a stage in
// Python.
#include "artifact/artifact.h"
#include "build_paths.h"
#include "foreign/stage_check.h"
#include "schema/schema.h"
#include "support/plane_meshes.h"
#include "support/workshop.h"

#include <algorithm>
#include <chrono>
#include <gmock/gmock.h>
#include <thread>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::run_command;
using test::TemporaryFolder;
using test::Workshop;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kDescribe = R"(
describe:
  summary: copies a mesh
  inputs: {mesh: {doc: any}, other: {schema: mesh, optional: true}}
  outputs: {mesh: {}}
  params:
    note: {type: string, default: "", doc: what is written down}
    rounds: {type: int, default: 3, min: 0, max: 9, doc: how often}
)";

// read -> copy, where `copy` is a described command line in copy.yaml: copy.sh IN OUT WORDS...
class CommandFileTest : public testing::Test {
protected:
    CommandFileTest()
    {
        shop_.write("copy.sh", "#!/bin/bash\necho \"$@\" >> \"$(dirname \"$0\")/log\"\ncp \"$1\" \"$2\"\n");
        fs::permissions(shop_ / "copy.sh", fs::perms::owner_all);
        describe(
            R"(exec: [copy.sh, "{in.mesh}", "{out.mesh}", "note={param.note}", "{param.rounds}", "--with={in.other}"])");
        use("./copy.yaml");
    }

    void describe(const std::string& exec) { shop_.write("copy.yaml", exec + kDescribe); }
    void use(const std::string& program, const std::string& more = "")
    {
        shop_.write("c.yaml", "version: 1\nstages:\n  read: {use: read, in: {folder: $scan}}\n  copy: {use: " +
                                  program + ", in: {mesh: read.mesh}" + more + "}\n");
    }
    CommandResult run(const std::string& options = "")
    {
        return shop_.quoin("run c.yaml --scan scans/a --out out " + options);
    }
    std::size_t calls()
    {
        std::ifstream file(shop_ / "log");
        const std::string text((std::istreambuf_iterator<char>(file)), {});
        log_ = text;
        return static_cast<std::size_t>(std::ranges::count(text, '\n'));
    }

    Workshop shop_{{"a"}};
    std::string log_;
};

TEST_F(CommandFileTest, RunsAsAStageWithItsParametersAndIsKeptInTheStore)
{
    const CommandResult first = run("-S copy.rounds=5 -S 'copy.note=two words'");
    ASSERT_EQ(first.exit_code, 0) << first.output;
    EXPECT_EQ(calls(), 1U);
    EXPECT_THAT(log_, AllOf(HasSubstr("note=two words 5"), Not(HasSubstr("--with="))));
    EXPECT_EQ(shop_.digests("out").at("a/copy.mesh"), shop_.digests("out").at("a/read.mesh"));
    EXPECT_EQ(read_run_record(shop_ / "out/a/copy/record.json")->stage, "copy");
    EXPECT_THAT(run("-S copy.rounds=5 -S 'copy.note=two words'").output, HasSubstr("nothing to compute"));
    EXPECT_EQ(calls(), 1U);
}

TEST_F(CommandFileTest, RunsAgainWhenItsFilesChangeAndNotWhenTheyMove)
{
    ASSERT_EQ(run().exit_code, 0);
    fs::create_directory(shop_ / "moved");
    for (const char* file : {"copy.yaml", "copy.sh"})
        fs::copy(shop_ / file, shop_ / "moved" / file);
    EXPECT_THAT(run("--use copy=moved/copy.yaml").output, HasSubstr("nothing to compute"));
    std::ofstream(shop_ / "copy.sh", std::ios::app) << "# changed\n";
    EXPECT_THAT(run().output, HasSubstr("1 stage computed"));
    EXPECT_EQ(calls(), 2U);
}

TEST_F(CommandFileTest, StandsInAPipelineToo)
{
    shop_.write("c.yaml", "version: 1\nstages:\n  read: {use: read, in: {folder: $scan}}\n  twin:\n"
                          "    exec: [cp, \"{in.mesh}\", \"{out.mesh}\"]\n"
                          "    describe: {inputs: {mesh: {}}, outputs: {mesh: {}}}\n    in: {mesh: read.mesh}\n");
    const CommandResult result = run();
    ASSERT_EQ(result.exit_code, 0) << result.output;
    EXPECT_EQ(shop_.digests("out").at("a/twin.mesh"), shop_.digests("out").at("a/read.mesh"));
    shop_.write("over.yaml", "version: 1\nextends: c.yaml\n");
    EXPECT_THAT(shop_.quoin("run over.yaml --scan scans/a --out out").output, HasSubstr("nothing to compute"));
}

TEST_F(CommandFileTest, WorksFromMakeWithTheSameKey)
{
    ASSERT_EQ(run("--store store").exit_code, 0);
    ASSERT_EQ(shop_.quoin("emit make c.yaml --scan scans/a --out made --store store --to Makefile").exit_code, 0);
    const CommandResult made = shop_.shell("make");
    ASSERT_EQ(made.exit_code, 0) << made.output;
    EXPECT_EQ(shop_.digests("made"), shop_.digests("out"));
    EXPECT_EQ(calls(), 1U);
    std::this_thread::sleep_for(std::chrono::milliseconds(20)); // make goes by stamps, whose clock ticks every few
    std::ofstream(shop_ / "copy.sh", std::ios::app) << "# changed\n";
    ASSERT_EQ(shop_.shell("make").exit_code, 0);
    EXPECT_EQ(calls(), 2U);
}

TEST_F(CommandFileTest, SaysWhatIsWrongAndWhere)
{
    describe(R"(exec: [copy.sh, "{in.mseh}", "{out.mesh}"])");
    EXPECT_THAT(run().output,
                HasSubstr("copy.yaml:1:17: there is no placeholder '{in.mseh}'; did you mean 'in.mesh'?"));
    describe("exec: []");
    EXPECT_THAT(run().output, HasSubstr("'exec' is expected to be a list of words"));
    describe("exec: [cp]\ncode: [absent.py]");
    EXPECT_THAT(run().output, HasSubstr("absent.py: no such file"));
    shop_.write("copy.yaml", "exec: [cp]\n");
    EXPECT_THAT(run().output, HasSubstr("'describe' is missing"));
    shop_.write("copy.yaml",
                "exec: [cp]\ndescribe: {outputs: {mesh: {}}, params: {n: {type: int, default: x, doc: d}}}\n");
    EXPECT_THAT(run().output, AllOf(HasSubstr("copy.yaml:2:"), HasSubstr("a whole number")));
    describe(R"(exec: [copy.sh, "{in.mesh}", "{out.mesh}"])");
    EXPECT_THAT(run("-S copy.round=2").output, HasSubstr("did you mean 'rounds'?"));
    EXPECT_EQ(calls(), 0U);
}

TEST_F(CommandFileTest, AProgramThatFailsLeavesNothing)
{
    const std::vector<std::tuple<std::string, int, std::string>> cases = {
        {"echo 'copy: no such wall' >&2; exit 3", 3, "no such wall"},
        {"exit 1", 5, "'copy.sh' ended with exit code 1"},
        {"true", 5, "did not write its output 'mesh'"},
        {"echo rubbish > \"$2\"", 5, "output 'mesh' of the program is not what it promises"},
        {"head -c 300 \"$1\" > \"$2\"", 5, "output 'mesh' of the program is not what it promises"},
        {"kill -9 $$", 5, "ended with exit code 137"},
    };
    for (const auto& [body, code, message] : cases) {
        shop_.write("copy.sh", "#!/bin/bash\n" + body + "\n");
        const CommandResult result = run();
        EXPECT_EQ(result.exit_code, code) << body << result.output;
        EXPECT_THAT(result.output, HasSubstr(message));
        EXPECT_FALSE(fs::exists(shop_ / "out/a/copy/mesh.safetensors")) << body;
    }
    describe("exec: [no-such-program-anywhere]");
    EXPECT_THAT(run().output, HasSubstr("there is no program 'no-such-program-anywhere' in $PATH"));
}

TEST_F(CommandFileTest, DiesWithTheStage)
{
    shop_.write("copy.sh", "#!/bin/bash\necho $$ > \"$(dirname \"$0\")/pid\"; exec sleep 300\n");
    ASSERT_EQ(shop_.quoin("run c.yaml --scan scans/a --out out --until read").exit_code, 0);
    const CommandResult killed =
        shop_.shell(QUOIN_BINARY_DIR "/bin/run-command copy.yaml --in mesh=out/a/read/mesh.safetensors --out mesh=m & "
                                     "until [ -s pid ]; do sleep 0.1; done; kill -9 $!; wait $!; sleep 0.3; "
                                     "[ -e /proc/$(cat pid)/exe ] && echo it lives");
    EXPECT_THAT(killed.output, Not(HasSubstr("it lives")));
}

// Quoin's own program by its path is a foreign one: somebody may have built it from changed code.
TEST_F(CommandFileTest, AProgramNamedByItsPathHasTheContentOfItsFilesInItsKey)
{
    fs::create_directory(shop_ / "mine");
    fs::copy_file(QUOIN_BINARY_DIR "/bin/toy_stages", shop_ / "mine/scale");
    shop_.write("note.txt", "one");
    use("scale");
    ASSERT_EQ(run().exit_code, 0);
    use("./mine/scale", ", code: [note.txt]");
    const CommandResult mine = run();
    ASSERT_EQ(mine.exit_code, 0) << mine.output;
    EXPECT_THAT(mine.output, HasSubstr("1 stage computed"));
    EXPECT_THAT(run().output, HasSubstr("nothing to compute"));
    shop_.write("note.txt", "two");
    EXPECT_THAT(run().output, HasSubstr("1 stage computed"));
    use("scale", ", code: [note.txt]");
    EXPECT_THAT(run().output, HasSubstr("uses a stage of Quoin's, which has a version instead"));
}

std::vector<std::string> failures(const std::vector<CheckResult>& results)
{
    std::vector<std::string> failures;
    for (const auto& result : results)
        if (result.state == CheckResult::State::Failed) failures.push_back(result.name + ": " + result.note);
    return failures;
}

std::size_t skipped(const std::vector<CheckResult>& results)
{
    return static_cast<std::size_t>(std::ranges::count(results, CheckResult::State::Skipped, &CheckResult::state));
}

StageUnderTest foreign(const fs::path& program)
{
    return {{program, {}}, {QUOIN_BINARY_DIR "/bin/run-command", {program.string()}}, {}, {}};
}

TEST(StageCheck, PassesQuoinsOwnStages)
{
    for (const char* name : {"merge"}) {
        const Command program{fs::path(QUOIN_BINARY_DIR "/bin") / name, {}};
        const auto results = check_stage({program, program, {}, {}});
        EXPECT_THAT(failures(results), testing::IsEmpty());
        EXPECT_EQ(skipped(results), 0U);
        EXPECT_GE(results.size(), 15U);
    }
}

TEST(StageCheck, NamesWhatAProgramDoesWrong)
{
    const TemporaryFolder folder;
    const auto write = [&](const std::string& text) {
        std::ofstream(folder / "stage") << "#!/bin/bash\n" << text;
        fs::permissions(folder / "stage", fs::perms::owner_all);
        return check_stage(foreign(folder / "stage"));
    };
    EXPECT_THAT(failures(write("exit 1")), testing::ElementsAre(HasSubstr("describes itself")));
    const std::string describe =
        R"([ "$1" = --describe ] && { echo '{"name":"s","inputs":[{"port":"mesh"}],"outputs":[{"port":"mesh"}],)"
        R"("params":[{"name":"size","type":"float","default":1,"max":2,"doc":"d"}]}'; exit 0; })"
        "\nfor w in \"$@\"; do case $w in mesh=*out*) out=${w#mesh=};; mesh=*) in=${w#mesh=};; esac; done\n";
    // Takes everything, and writes something else every time.
    const auto careless = failures(write(describe + "cp \"$in\" \"$out\"; exit 0"));
    EXPECT_THAT(careless, testing::Contains(HasSubstr("refuses an unknown parameter")));
    EXPECT_THAT(careless, testing::Contains(HasSubstr("refuses values out of range")));
    EXPECT_THAT(careless, testing::Contains(HasSubstr("refuses a missing, damaged or other 'mesh'")));
    const auto half = failures(write(describe + "head -c 100 \"$in\" > \"$out\"; echo \"$@\" >&2; exit 2"));
    EXPECT_THAT(half, testing::Contains(HasSubstr("left mesh.safetensors behind")));
}

// Begins a command line in which python3 has numpy, or says why there is none.
std::string python_path()
{
    for (const char* path : {"", "PATH=/usr/bin:$PATH; "})
        if (run_command(std::string(path) + "python3 -c 'import numpy'").exit_code == 0) return path;
    return "none";
}

class PythonStage : public testing::Test {
protected:
    void SetUp() override
    {
        if (python_path() == "none") GTEST_SKIP() << "python3 with numpy is not installed (package python3-numpy)";
    }
    CommandResult shell(const std::string& command) const
    {
        return run_command(python_path() + "export PATH; cd '" + folder_.path().string() + "' && " + command);
    }
    PlaneMesh merged_by(const std::string& program) const
    {
        const CommandResult run = shell(program + " --in plane_mesh=in.safetensors --out plane_mesh=out.safetensors");
        EXPECT_EQ(run.exit_code, 0) << run.output;
        return read_plane_mesh(folder_ / "out.safetensors");
    }

    const std::string example_ = QUOIN_SOURCE_DIR "/docs/examples/merge-by-normal";
    TemporaryFolder folder_;
};

TEST_F(PythonStage, PassesStageCheck)
{
    const CommandResult check = shell(QUOIN_BINARY_DIR "/bin/quoin stage-check " + example_);
    EXPECT_EQ(check.exit_code, 0) << check.output;
    EXPECT_THAT(check.output, AllOf(HasSubstr(" 0 failed"), Not(HasSubstr("skipped"))));
}

TEST_F(PythonStage, MergesWhatMergeMerges)
{
    const Eigen::Vector3d o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    // A floor in two halves and a wall, and a step too high to be one plane with the floor.
    const PlaneMesh mesh = testing_support::join_sheets(
        {{o, x, y, 4}, {x, x, y, 4}, {o, z, x, 4}, {2 * x, y, 0.2 * z, 4}, {2 * x + 0.2 * z, x, y, 4}});
    write_artifact(folder_ / "in.safetensors", to_artifact(mesh));
    const PlaneMesh ours = merged_by(QUOIN_BINARY_DIR "/bin/merge");
    const PlaneMesh theirs = merged_by(QUOIN_BINARY_DIR "/bin/run-command " + example_);
    EXPECT_EQ(theirs.plane.size(), 4U);
    EXPECT_EQ(theirs.face_plane, ours.face_plane);
    EXPECT_EQ(theirs.vertex_class, ours.vertex_class);
    for (std::size_t p = 0; p < ours.plane.size(); ++p)
        EXPECT_LT((theirs.plane[p].normal - ours.plane[p].normal).norm() +
                      std::abs(theirs.plane[p].offset - ours.plane[p].offset),
                  1e-9);
}

} // namespace
} // namespace quoin
