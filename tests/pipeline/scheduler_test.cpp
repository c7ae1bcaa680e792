#include "pipeline/scheduler.h"

#include "base/error.h"
#include "pipeline/fake_stages.h"
#include "pipeline/pipeline_file.h"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <gmock/gmock.h>
#include <memory>
#include <unistd.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using test::FakeStages;
using test::TemporaryFolder;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

struct Recorder : RunObserver {
    std::vector<std::string> lines;
    std::vector<TaskProgress> progress;
    std::vector<std::size_t> ends;
    std::size_t running = 0;
    std::size_t most_running = 0;

    void started(std::size_t) override { most_running = std::max(most_running, ++running); }
    void progressed(std::size_t, const TaskProgress& update) override { progress.push_back(update); }
    void said(std::size_t, const std::string& line) override { lines.push_back(line); }
    void ended(std::size_t task, const TaskResult&) override
    {
        ends.push_back(task);
        --running;
    }
    void tick() override {}
};

// A diamond: source, then left and right, then sink.
constexpr const char* kDiamond =
    "version: 1\nstages:\n  source: {use: source}\n  left: {use: left, in: {a: source.a}}\n"
    "  right: {use: right, in: {a: source.a}}\n  sink: {use: sink, in: {b: left.b, c: right.c}}\n";

class SchedulerTest : public testing::Test {
protected:
    RunOutcome run(const std::string& source, const std::string& left, const std::string& right, const Budget& budget)
    {
        stages_ = std::make_unique<FakeStages>(std::vector<test::FakeStage>{{"source", {}, {"a"}, source},
                                                                            {"left", {"a"}, {"b"}, left},
                                                                            {"right", {"a"}, {"c"}, right},
                                                                            {"sink", {"b", "c"}, {"d"}}});
        Problems problems;
        const Pipeline pipeline = parse_pipeline("p.yaml", kDiamond, problems);
        Catalogue catalogue(stages_->folder());
        const Graph graph = build_graph(pipeline, catalogue, std::move(problems));
        const auto tasks = plan_tasks(graph, {{"room", {}}}, {folder_.path(), folder_.path() / ".store"}, {});
        return run_tasks(tasks, budget, recorder_);
    }

    static TaskState state(const RunOutcome& outcome, std::size_t task) { return outcome.results[task].state; }

    std::unique_ptr<FakeStages> stages_;
    TemporaryFolder folder_;
    Recorder recorder_;
};

TEST_F(SchedulerTest, RunsAStageWhenItsInputsAreThere)
{
    const RunOutcome outcome = run("", "", "", {});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(stages_->log(), ElementsAre("start source", "end source", "start left", "end left", "start right",
                                            "end right", "start sink", "end sink"));
    EXPECT_TRUE(fs::exists(folder_.path() / "room/sink/d.safetensors"));
    EXPECT_EQ(outcome.results[0].record->seconds, 1.5);
}

TEST_F(SchedulerTest, RunsIndependentStagesSideBySide)
{
    // Each waits for the other to have started: one after the other they would wait for ever.
    const auto wait_for = [](const std::string& other) {
        return "until grep -q 'start " + other + "' $here/log; do sleep 0.01; done";
    };
    const RunOutcome outcome =
        run("", wait_for("right"), wait_for("left"),
            {.jobs = 2, .threads = 4, .memory = 0, .keep_going = false, .store = {}, .log_level = "warning"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(recorder_.most_running, 2U);
}

TEST_F(SchedulerTest, DividesThreadsAndMemoryAmongThoseThatStartTogether)
{
    run("", "", "", {.jobs = 2, .threads = 8, .memory = 1000, .keep_going = false, .store = {}, .log_level = "info"});
    EXPECT_THAT(stages_->arguments("source"), HasSubstr("--threads 8 --memory 1000 --progress json --log-level info"));
    EXPECT_THAT(stages_->arguments("left"), HasSubstr("--threads 4 --memory 500"));
    EXPECT_THAT(stages_->arguments("sink"), HasSubstr("--threads 8"));
}

TEST_F(SchedulerTest, StopsAfterAFailureAndReturnsItsCode)
{
    const RunOutcome outcome = run("", "echo 'left: error: no plane' >&2; exit 5", "", {});
    EXPECT_EQ(outcome.exit_code, 5);
    EXPECT_EQ(state(outcome, 0), TaskState::Computed);
    EXPECT_EQ(state(outcome, 1), TaskState::Failed);
    EXPECT_EQ(state(outcome, 2), TaskState::NotRun);
    EXPECT_EQ(state(outcome, 3), TaskState::NotRun);
    EXPECT_THAT(recorder_.lines, ElementsAre("left: error: no plane"));
    EXPECT_TRUE(fs::exists(folder_.path() / "room/source/a.safetensors"));
}

TEST_F(SchedulerTest, KeepsGoingWithWhatDoesNotDependOnTheFailure)
{
    const RunOutcome outcome =
        run("", "exit 3", "",
            {.jobs = 1, .threads = 1, .memory = 0, .keep_going = true, .store = {}, .log_level = "warning"});
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_EQ(state(outcome, 2), TaskState::Computed);
    EXPECT_EQ(state(outcome, 3), TaskState::NotRun);
}

TEST_F(SchedulerTest, ReportsASignalAsACode) { EXPECT_EQ(run("kill -SEGV $$", "", "", {}).exit_code, 128 + SIGSEGV); }

TEST_F(SchedulerTest, TellsProgressFromWords)
{
    run(R"(echo '{"part":"fusing frames","done":3,"total":10}' >&2; echo '{"not":"progress"}' >&2; printf 'half a line' >&2)",
        "", "", {});
    ASSERT_EQ(recorder_.progress.size(), 1U);
    EXPECT_EQ(recorder_.progress[0].part, "fusing frames");
    EXPECT_EQ(recorder_.progress[0].done, 3U);
    EXPECT_EQ(recorder_.progress[0].total, 10U);
    EXPECT_THAT(recorder_.lines, ElementsAre(R"({"not":"progress"})", "half a line"));
}

TEST_F(SchedulerTest, EndsWhatAStageLeavesBehind)
{
    run("sleep 300 & echo $! > $here/orphan", "", "", {});
    std::ifstream file(stages_->folder() / "orphan");
    int pid = 0;
    file >> pid;
    ASSERT_GT(pid, 0);
    for (int i = 0; i < 200 && fs::exists("/proc/" + std::to_string(pid) + "/exe"); ++i)
        ::usleep(10'000);
    EXPECT_FALSE(fs::exists("/proc/" + std::to_string(pid) + "/exe")); // a zombie of init has no exe
}

TEST_F(SchedulerTest, SaysThatAStageLeftProcessesBehind)
{
    run("sleep 300 & sleep 300 &", "", "", {});
    EXPECT_THAT(recorder_.lines, ElementsAre("left 2 of its processes running; they were ended"));
}

TEST_F(SchedulerTest, RefusesAStageThatEndsWithoutItsOutput)
{
    const RunOutcome outcome = run("", "exit 0", "", {});
    EXPECT_EQ(outcome.exit_code, 5);
    EXPECT_EQ(state(outcome, 1), TaskState::Failed);
    EXPECT_THAT(recorder_.lines, ElementsAre(HasSubstr("ended with exit code 0, but did not write its output 'b' (")));
}

TEST_F(SchedulerTest, RefusesAnOutputOfAnotherSchema)
{
    const RunOutcome outcome = run("", R"(cp $here/source.a.artifact "${outputs[0]#*=}"; exit 0)", "", {});
    EXPECT_EQ(outcome.exit_code, 5);
    EXPECT_THAT(recorder_.lines, ElementsAre(HasSubstr("wrote a 'a' as its output 'b', which is a 'b' (")));
}

TEST_F(SchedulerTest, RefusesAnOutputThatIsNoArtifact)
{
    run("", R"(echo hello > "${outputs[0]#*=}"; exit 0)", "", {});
    EXPECT_THAT(recorder_.lines, ElementsAre(HasSubstr("wrote an output 'b' that is no artifact: ")));
}

TEST_F(SchedulerTest, EndsAStageThatHangs)
{
    Budget budget;
    budget.timeout = 5.0; // the other stages end within it, however busy the machine is
    const RunOutcome outcome = run("", "exec sleep 300", "", budget);
    EXPECT_EQ(outcome.exit_code, 4);
    EXPECT_EQ(state(outcome, 1), TaskState::Failed);
    EXPECT_THAT(recorder_.lines, ElementsAre(HasSubstr("was ended after ")));
}

TEST_F(SchedulerTest, ShowsOnlySoMuchOfWhatAStagePrints)
{
    const RunOutcome outcome = run("head -c 3000000 /dev/zero | tr '\\0' x; echo; seq 100000", "", "", {});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_LE(recorder_.lines.size(), 501U);
    EXPECT_THAT(recorder_.lines.back(), HasSubstr("has said 500 lines; the rest is not shown"));
    for (const auto& line : recorder_.lines)
        EXPECT_LE(line.size(), 1100U);
}

TEST_F(SchedulerTest, TriesAStageAgainWithMoreMemory)
{
    Budget budget;
    budget.memory = 1'000'000'000;
    budget.memory_need = [](const Task& task) { return task.stage == "left" ? 100'000'000U : 0U; };
    budget.jobs = budget.threads = 2;
    const RunOutcome outcome = run("",
                                   "until grep -q 'start right' $here/log; do sleep 0.01; done; [ -e $here/once ] || { "
                                   "touch $here/once; exit 4; }",
                                   "", budget);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(recorder_.lines, ElementsAre(HasSubstr("trying again with 1.0 GB instead of 500 MB (try 2 of 3)")));
    EXPECT_THAT(stages_->arguments("left"), HasSubstr("--memory 1000000000"));
}

TEST_F(SchedulerTest, TriesAStageAgainThatAsksForIt)
{
    Budget budget;
    budget.retry_seconds = 0.01;
    EXPECT_EQ(run("", "[ -e $here/once ] || { touch $here/once; exit 75; }", "", budget).exit_code, 0);
    EXPECT_THAT(recorder_.lines, ElementsAre(HasSubstr("(try 2 of 3)")));
}

TEST_F(SchedulerTest, GivesUpAfterThreeTries)
{
    Budget budget;
    budget.retry_seconds = 0.01;
    EXPECT_EQ(run("", "exit 75", "", budget).exit_code, 75);
    EXPECT_THAT(stages_->log(), testing::Not(Contains("start sink")));
    EXPECT_EQ(std::ranges::count(stages_->log(), "start left"), 3);
}

TEST_F(SchedulerTest, RunsSideBySideOnlyWhatFitsIntoMemory)
{
    Budget budget;
    budget.memory = 1000;
    budget.jobs = budget.threads = 2;
    budget.memory_need = [](const Task&) { return 600U; };
    EXPECT_EQ(run("", "", "", budget).exit_code, 0);
    EXPECT_EQ(recorder_.most_running, 1U);
}

TEST_F(SchedulerTest, MeasuresTheStage)
{
    const RunOutcome outcome = run("", "", "", {});
    EXPECT_GT(outcome.results[0].end.peak_memory_bytes, 100'000U);
    EXPECT_GT(outcome.results[0].seconds, 0.0);
}

} // namespace
} // namespace quoin
