// kill -9 at every point and at random moments, each run then resumed: equal digests, nothing lost, nothing left but
// what gc removes. QUOIN_KILLS says how many (bench/kills: 500).
#include "kills/toy_runs.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <gmock/gmock.h>
#include <random>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::Digests;
using test::ToyRuns;
using testing::HasSubstr;

constexpr const char* kPoints[] = {"lease_taken",   "artifact_half_written", "object_written", "object_published",
                                   "entry_written", "entry_published",       "outputs_linked"};
constexpr const char* kStages[] = {"toy-source", "toy-scale", "toy-join", "toy-folder"}; // the last writes no artifact
constexpr int kFewKills = 21;                                                            // in ./dev test

int kill_count()
{
    const char* variable = std::getenv("QUOIN_KILLS");
    return variable ? std::atoi(variable) : kFewKills;
}

pid_t start(const std::string& command)
{
    const pid_t pid = ::fork();
    if (pid == 0) {
        ::execl("/bin/sh", "sh", "-c", (command + " >/dev/null 2>&1").c_str(), nullptr);
        ::_exit(127);
    }
    return pid;
}

// The processes whose parent is `parent`.
std::vector<pid_t> children_of(pid_t parent)
{
    std::vector<pid_t> children;
    for (const auto& entry : fs::directory_iterator("/proc")) {
        const int pid = std::atoi(entry.path().filename().c_str());
        std::ifstream status(entry.path() / "stat");
        std::string text;
        if (pid <= 0 || !std::getline(status, text)) continue;
        int found = 0;
        char state = 0;
        if (std::sscanf(text.c_str() + text.rfind(')') + 1, " %c %d", &state, &found) == 2 && found == parent)
            children.push_back(pid);
    }
    return children;
}

// The driver and its stages die at once, as when a machine stops.
void kill_all(pid_t driver)
{
    ::kill(driver, SIGSTOP);
    for (const pid_t child : children_of(driver))
        ::kill(child, SIGKILL);
    ::kill(driver, SIGKILL);
    ::waitpid(driver, nullptr, 0);
}

struct Tally {
    int killed = 0, resumed = 0;
    std::size_t temporaries = 0;
};

class Kills : public testing::Test {
protected:
    std::string options(int i) const { return "--threads 2 -S source.seed=" + std::to_string(i + 1); }

    Digests reference(int i)
    {
        EXPECT_EQ(test::run_command(runs_.command("reference", "reference-store", options(i))).exit_code, 0);
        return runs_.digests("reference");
    }

    void kill_at_point(int i, std::mt19937& random)
    {
        const std::string point = kPoints[static_cast<std::size_t>(i) % std::size(kPoints)];
        const std::string stage = kStages[random() % (point == "artifact_half_written" ? 3 : 4)];
        const CommandResult killed = test::run_command("export QUOIN_FAIL_POINT=" + stage + "/" + point + "; " +
                                                       runs_.command("out", "store", options(i)));
        EXPECT_NE(killed.exit_code, 0) << stage << "/" << point;
        if (killed.exit_code != 0) ++tally_.killed;
    }

    void kill_at_random(int i, std::mt19937& random)
    {
        const pid_t driver = start(runs_.command("out", "store", options(i)));
        std::this_thread::sleep_for(std::chrono::microseconds(random() % 250'000));
        kill_all(driver);
        ++tally_.killed;
    }

    void resume(int i)
    {
        const auto entries = runs_.files("store/v1/ac");
        tally_.temporaries += runs_.files("store/v1/tmp").size();
        const CommandResult resumed = test::run_command(runs_.command("out", "store", options(i)));
        ASSERT_EQ(resumed.exit_code, 0) << resumed.output;
        EXPECT_EQ(runs_.digests("out"), reference(i));
        const auto now = runs_.files("store/v1/ac");
        EXPECT_TRUE(std::ranges::includes(now, entries)) << "an entry was lost";
        EXPECT_EQ(now.size(), static_cast<std::size_t>(5 * (i + 1)));
        ++tally_.resumed;
    }

    ToyRuns runs_;
    Tally tally_;
};

TEST_F(Kills, AKilledRunIsResumedWithEqualDigestsAndNothingLost)
{
    std::mt19937 random(20261125);
    const int count = kill_count();
    for (int i = 0; i < count; ++i) {
        // The store is made by the first run that is killed.
        if (i % 3 != 2)
            kill_at_point(i, random);
        else
            kill_at_random(i, random);
        fs::create_directories(runs_.path("store/v1/ac"));
        fs::create_directories(runs_.path("store/v1/tmp"));
        resume(i);
        if (HasFatalFailure()) return;
    }
    const auto left_in_results = runs_.files("out/room");
    EXPECT_TRUE(std::ranges::none_of(left_in_results, [](const auto& name) { return name.ends_with(".tmp"); }));
    const CommandResult verified = runs_.quoin("verify --store store");
    EXPECT_EQ(verified.exit_code, 0) << verified.output;
    const CommandResult collected = runs_.quoin("gc --store store");
    EXPECT_EQ(collected.exit_code, 0) << collected.output;
    EXPECT_TRUE(fs::is_empty(runs_.path("store/v1/tmp")));
    EXPECT_TRUE(fs::is_empty(runs_.path("store/v1/lease")));
    EXPECT_EQ(runs_.files("store/v1/ac").size(), static_cast<std::size_t>(5 * count)); // gc took rubbish only
    std::printf(
        "%d runs killed (%d asked for), %d resumed with equal digests; %zu temporaries were left, gc removed all\n",
        tally_.killed, count, tally_.resumed, tally_.temporaries);
}

TEST_F(Kills, TwoRunsAtOnceComputeEachKeyOnce)
{
    const pid_t first = start(runs_.command("one", "store", "--jobs 2 --threads 2"));
    const pid_t second = start(runs_.command("two", "store", "--jobs 2 --threads 2"));
    int status = 0;
    for (const pid_t pid : {first, second}) {
        ::waitpid(pid, &status, 0);
        EXPECT_EQ(WEXITSTATUS(status), 0);
    }
    EXPECT_EQ(runs_.digests("one"), runs_.digests("two"));
    std::map<std::string, int> computed; // key -> how often
    for (const char* out : {"one", "two"})
        for (const auto& entry : fs::directory_iterator(runs_.path(out) / "room"))
            if (const auto record = read_run_record(entry.path() / "record.json"))
                computed[record->key] += !record->cached;
    EXPECT_EQ(computed.size(), 5U);
    for (const auto& [key, times] : computed)
        EXPECT_EQ(times, 1) << key;
}

} // namespace
} // namespace quoin
