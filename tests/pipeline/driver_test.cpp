// The driver as a program: its exit codes, its words, and that killing it leaves nothing running and nothing
// half-written.
#include "build_paths.h"
#include "pipeline/fake_stages.h"
#include "support/file_text.h"

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using test::FakeStages;
using test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;

struct Finished {
    int code = 0;
    std::string out, err;
};

class DriverTest : public testing::Test {
protected:
    void make(const std::vector<test::FakeStage>& stages, const std::string& pipeline)
    {
        stages_ = std::make_unique<FakeStages>(stages);
        std::ofstream(folder_.path() / "p.yaml") << pipeline;
        fs::create_directories(folder_.path() / "room");
    }

    // Starts the driver; its stages are the fake ones.
    pid_t start(const std::string& arguments)
    {
        const std::string command = "cd '" + folder_.path().string() + "' && QUOIN_STAGES='" +
                                    stages_->folder().string() + "' exec '" + QUOIN_BINARY_DIR "/bin/quoin' " +
                                    arguments + " > stdout 2> stderr";
        const pid_t pid = ::fork();
        if (pid == 0) {
            ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
            ::_exit(127);
        }
        return pid;
    }

    Finished finish(pid_t pid)
    {
        int status = 0;
        ::waitpid(pid, &status, 0);
        return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
                test::file_text(folder_.path() / "stdout"), test::file_text(folder_.path() / "stderr")};
    }

    Finished quoin(const std::string& arguments) { return finish(start(arguments)); }

    int wait_for_pid_in(const std::string& file)
    {
        int pid = 0;
        for (int i = 0; i < 1000 && pid == 0; ++i) {
            ::usleep(10'000);
            std::ifstream(stages_->folder() / file) >> pid;
        }
        return pid;
    }

    static bool ends_soon(int pid)
    {
        for (int i = 0; i < 500; ++i, ::usleep(10'000))
            if (!fs::exists("/proc/" + std::to_string(pid) + "/exe")) return true;
        return false;
    }

    std::unique_ptr<FakeStages> stages_;
    TemporaryFolder folder_;
};

constexpr const char* kImport = "version: 1\nstages:\n  import: {use: import, in: {folder: $scan}}\n";
const test::FakeStage kSleeper{"import", {"folder"}, {"scan"}, "echo $$ > $here/pid; exec sleep 300"};

TEST_F(DriverTest, RunsAPipelineAndPrintsWhereTheResultsAre)
{
    make({{"import", {"folder"}, {"scan"}}}, kImport);
    const Finished run = quoin("run p.yaml --scan room --out results");
    EXPECT_EQ(run.code, 0);
    EXPECT_EQ(run.out, "results/room\n");
    EXPECT_THAT(run.err, HasSubstr("1 stage computed in"));
    EXPECT_TRUE(fs::exists(folder_.path() / "results/room/import/scan.safetensors"));
    EXPECT_THAT(quoin("status results").out, HasSubstr("import"));
}

TEST_F(DriverTest, StartsNothingWhenThePipelineIsWrong)
{
    make({{"import", {"folder"}, {"scan"}}}, std::string(kImport) + "  fuse: {use: import}\n  fuse: {use: imprt}\n");
    const Finished run = quoin("run p.yaml --scan room");
    EXPECT_EQ(run.code, 2);
    EXPECT_THAT(run.err, AllOf(HasSubstr("p.yaml:5:3: key 'fuse' stands here a second time"),
                               HasSubstr("p.yaml:4:3: input 'folder' of stage 'fuse' is not wired")));
    EXPECT_TRUE(stages_->log().empty());
}

TEST_F(DriverTest, ShowsAFailureOnceAndReturnsItsCode)
{
    make({{"import", {"folder"}, {"scan"}, "echo 'import: error: room: no frames' >&2; exit 3"}}, kImport);
    const Finished run = quoin("run p.yaml --scan room");
    EXPECT_EQ(run.code, 3);
    const std::size_t first = run.err.find("room: no frames");
    ASSERT_NE(first, std::string::npos);
    EXPECT_EQ(run.err.find("room: no frames", first + 1), std::string::npos);
    EXPECT_THAT(run.err, HasSubstr("failed (exit code 3)"));
    EXPECT_EQ(run.out, "");
}

TEST_F(DriverTest, EndsItsStagesWhenItIsInterrupted)
{
    make({kSleeper}, kImport);
    for (const int signal : {SIGINT, SIGTERM}) {
        fs::remove(stages_->folder() / "pid");
        const pid_t driver = start("run p.yaml --scan room");
        const int stage = wait_for_pid_in("pid");
        ASSERT_GT(stage, 0);
        ::kill(driver, signal);
        EXPECT_EQ(finish(driver).code, 128 + signal);
        EXPECT_TRUE(ends_soon(stage));
        EXPECT_FALSE(fs::exists(folder_.path() / "out/room/import/scan.safetensors"));
    }
}

TEST_F(DriverTest, LeavesNoStageRunningWhenItIsKilled)
{
    make({kSleeper}, kImport);
    const pid_t driver = start("run p.yaml --scan room");
    const int stage = wait_for_pid_in("pid");
    ASSERT_GT(stage, 0);
    ::kill(driver, SIGKILL);
    finish(driver);
    EXPECT_TRUE(ends_soon(stage));
}

TEST_F(DriverTest, BecomesAStageByItsName)
{
    make({{"import", {"folder"}, {"scan"}}}, kImport);
    EXPECT_THAT(quoin("import --describe").out, HasSubstr(R"("name":"import")"));
    EXPECT_EQ(quoin("import --out scan=x --record r").code, 0);
}

TEST_F(DriverTest, NamesTheNearestVerbStageOrOption)
{
    make({{"import", {"folder"}, {"scan"}}}, kImport);
    EXPECT_THAT(quoin("rum").err, HasSubstr("there is no verb or stage 'rum'; did you mean 'run'?"));
    EXPECT_THAT(quoin("imporr").err, HasSubstr("did you mean 'import'?"));
    EXPECT_THAT(quoin("run --scna x").err, HasSubstr("there is no option '--scna'; did you mean '--scan'?"));
    EXPECT_EQ(quoin("rum").code, 2);
    EXPECT_EQ(quoin("run --threads many").code, 2);
}

TEST_F(DriverTest, FindsPipelinesByName)
{
    make({{"import", {"folder"}, {"scan"}}}, kImport);
    const std::string folder = "graph p.yaml";
    EXPECT_EQ(quoin(folder).out, "import  $scan -> scan\n");
    ::setenv("QUOIN_PIPELINES", folder_.path().c_str(), 1);
    EXPECT_EQ(quoin("graph p").out, "import  $scan -> scan\n");
    EXPECT_THAT(quoin("graph q").err, HasSubstr("there is no 'q' in"));
    ::unsetenv("QUOIN_PIPELINES");
}

TEST_F(DriverTest, DrawsWhatTheStoreHas)
{
    make({{"import", {"folder"}, {"scan"}}}, kImport);
    EXPECT_EQ(quoin("graph p.yaml --scan room").out, "import  to compute  $scan -> scan\n");
    const fs::path tools = folder_.path() / "tools";
    fs::create_directories(tools);
    std::ofstream(tools / "dot") << "#!/bin/sh\n[ $1 = -Tsvg ] && grep -q digraph $2 && echo '<svg/>'\n";
    fs::permissions(tools / "dot", fs::perms::owner_all);
    const std::string path = std::getenv("PATH");
    ::setenv("PATH", (tools.string() + ":" + path).c_str(), 1);
    EXPECT_EQ(quoin("graph p.yaml --format svg").out, "<svg/>\n");
    fs::remove(tools / "dot");
    for (const std::string tool : {"bash", "cat", "dirname"}) // that the fake stages need
        fs::create_symlink("/usr/bin/" + tool, tools / tool);
    ::setenv("PATH", tools.c_str(), 1);
    const Finished without = quoin("graph p.yaml --format svg");
    ::setenv("PATH", path.c_str(), 1);
    EXPECT_THAT(without.err, HasSubstr("--format svg needs Graphviz"));
}

TEST_F(DriverTest, ComparesVariantsThatShareTheirFirstStages)
{
    make({{"import", {"folder"}, {"scan"}}, {"fuse", {"scan"}, {"mesh"}}},
         std::string(kImport) + "  fuse: {use: fuse, in: {scan: import.scan}}\n"
                                "variants: {fine: {fuse.size: 0.1}, same: {fuse.size: 0.5}}\n");
    const Finished run =
        quoin("ablate p.yaml --scan room --out results --vary fuse.count=4 --vary fuse.mode=exact,fats");
    EXPECT_EQ(run.code, 2);
    EXPECT_THAT(run.err, HasSubstr("--vary: stage 'fuse': parameter 'mode' is 'fats': expected one of fast, exact; did "
                                   "you mean 'fast'?"));
    EXPECT_TRUE(stages_->log().empty());
    const Finished good = quoin("ablate p.yaml --scan room --out results --vary fuse.count=4");
    EXPECT_EQ(good.code, 0) << good.err;
    EXPECT_THAT(good.err, HasSubstr("same is the same as baseline; left out"));
    EXPECT_THAT(good.out, HasSubstr("seconds [s], lower is better"));
    EXPECT_THAT(good.out, AllOf(HasSubstr("\n  baseline"), HasSubstr("\n  fine"), HasSubstr("\n  fuse.count=4")));
    EXPECT_TRUE(fs::exists(folder_.path() / "results/fuse.count=4/room/fuse/mesh.safetensors"));
    for (const char* file : {"ablation.txt", "ablation.csv", "ablation.tex", "ablation.html", "ablation-values.csv"})
        EXPECT_TRUE(fs::exists(folder_.path() / "results" / file)) << file;
    EXPECT_EQ(quoin("run p.yaml --scan room --out one --variant fine").code, 0);
    EXPECT_THAT(stages_->arguments("fuse"), HasSubstr("--set size=0.1"));
}

TEST_F(DriverTest, PlansWithoutMakingAnything)
{
    make({{"import", {"folder"}, {"scan"}}}, kImport);
    EXPECT_THAT(quoin("plan p.yaml --scan room --out results").out, HasSubstr("to compute"));
    EXPECT_THAT(quoin("run p.yaml --scan room --out results --dry-run").out, HasSubstr("0 in the store, 1 to compute"));
    EXPECT_FALSE(fs::exists(folder_.path() / "results"));
}

} // namespace
} // namespace quoin
