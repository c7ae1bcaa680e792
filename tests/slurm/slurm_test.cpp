// `quoin submit` on a real Slurm: it gives what `quoin run` gives, whatever fails on the way.
#include "build_paths.h"
#include "slurm/local_slurm.h"
#include "support/workshop.h"

#include <algorithm>
#include <charconv>
#include <gmock/gmock.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::Digests;
using test::LocalSlurm;
using test::Workshop;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class SlurmTest : public testing::Test {
protected:
    static void SetUpTestSuite()
    {
        if (LocalSlurm::missing().empty()) slurm_ = std::make_unique<LocalSlurm>();
    }
    static void TearDownTestSuite() { slurm_.reset(); }

    void SetUp() override
    {
        if (!slurm_) GTEST_SKIP() << LocalSlurm::missing();
        ASSERT_TRUE(slurm_->is_up()) << slurm_->log();
    }

    CommandResult shell(const std::string& command) const { return shop_.shell(slurm_->environment() + command); }
    CommandResult quoin(const std::string& arguments) const
    {
        return shell(QUOIN_BINARY_DIR "/bin/quoin " + arguments);
    }

    // What `emit slurm` and `submit` are called with; the scripts lie in results/.slurm, or so.
    std::string options(const std::string& more = "", const std::string& out = "results", int threads = 1) const
    {
        return " slurm p.yaml" + shop_.scan_options() + " --out " + out + " --store store --to " + out +
               "/.slurm --mem 100M --threads " + std::to_string(threads) + " " + more;
    }
    CommandResult submit(const std::string& more = "", int threads = 1) const
    {
        return quoin("submit" + options(more, "results", threads).substr(6));
    }
    std::string status(const std::string& out = "results") const { return quoin("status " + out + "/.slurm").output; }

    void submit_and_wait(const std::string& options = "")
    {
        const CommandResult submitted = submit(options);
        ASSERT_EQ(submitted.exit_code, 0) << submitted.output;
        ASSERT_TRUE(slurm_->wait_for_jobs()) << slurm_->call("squeue");
    }

    Digests digests_of_run(const std::string& options = "") const
    {
        const CommandResult run = shop_.quoin("run p.yaml" + shop_.scan_options() + " --out run " + options);
        EXPECT_EQ(run.exit_code, 0) << run.output;
        return shop_.digests("run");
    }

    std::string logs() const { return shell("tail -n 5 results/.slurm/logs/*").output; }

    // Processes of a job but those of Slurm itself.
    static std::vector<int> processes_of(const std::string& job)
    {
        std::vector<int> pids;
        for (const auto& entry : fs::directory_iterator("/proc")) {
            int pid = 0;
            const std::string name = entry.path().filename().string();
            if (std::from_chars(name.data(), name.data() + name.size(), pid).ec != std::errc()) continue;
            std::ifstream file(entry.path() / "environ", std::ios::binary);
            const std::string environment((std::istreambuf_iterator<char>(file)), {});
            if (environment.find("SLURM_ARRAY_JOB_ID=" + job + '\0') != std::string::npos) pids.push_back(pid);
        }
        return pids;
    }

    inline static std::unique_ptr<LocalSlurm> slurm_;
    Workshop shop_{{"a", "b", "c", "d"}};
};

TEST_F(SlurmTest, GivesTheDigestsOfTheDriver)
{
    submit_and_wait("--max-array-size 3"); // d is element 0 of second arrays
    EXPECT_EQ(shop_.digests("results"), digests_of_run()) << logs();
    EXPECT_THAT(status(), AllOf(HasSubstr("4 in the store"), Not(HasSubstr("failed"))));
    EXPECT_THAT(submit().output, HasSubstr("nothing to submit"));
    EXPECT_THAT(quoin("run p.yaml" + shop_.scan_options() + " --out results --store store").output,
                HasSubstr("nothing to compute"));
}

TEST_F(SlurmTest, AFailedElementStopsItsOwnScanOnlyAndIsSubmittedAgainAlone)
{
    shop_.write("scans/b/broken", "");
    submit_and_wait();
    EXPECT_EQ(shop_.digests("results").size(), 15U) << logs(); // three scans of five stages
    EXPECT_THAT(status(), AllOf(HasSubstr("1 failed"), HasSubstr("3 in the store"), HasSubstr("1 cancelled"),
                                HasSubstr("b: read failed; see results/.slurm/logs/quoin-read")));
    EXPECT_THAT(logs(), HasSubstr("the scan is broken"));
    fs::remove(shop_ / "scans/b/broken");
    const CommandResult again = submit();
    EXPECT_THAT(again.output, AllOf(HasSubstr("read.1: job"), HasSubstr("elements 1\n"), HasSubstr("elements 1, after"),
                                    Not(HasSubstr("0-3"))));
    ASSERT_TRUE(slurm_->wait_for_jobs());
    EXPECT_EQ(shop_.digests("results"), digests_of_run());
}

// One array of both kinds would wait for b's parent in all its elements, and be cancelled with it.
TEST_F(SlurmTest, KeepsScansWhoseParentsAreInTheStoreApartFromThoseWhoseParentsRunAgain)
{
    shop_.write("scans/b/broken", "");
    submit_and_wait("--until read");
    const CommandResult again = submit();
    EXPECT_THAT(again.output, AllOf(HasSubstr("small.1: job"), HasSubstr("elements 0,2-3\n"), HasSubstr("small.2: job"),
                                    HasSubstr("elements 1, after read.1\n")));
    ASSERT_TRUE(slurm_->wait_for_jobs());
    EXPECT_EQ(shop_.digests("results").size(), 15U) << logs();
}

TEST_F(SlurmTest, GoesOnAfterAJobWasKilled)
{
    const CommandResult submitted = submit("-S large.pause=30 -S small.pause=0");
    ASSERT_EQ(submitted.exit_code, 0) << submitted.output;
    const std::size_t at = submitted.output.find("large.1: job ");
    ASSERT_NE(at, std::string::npos) << submitted.output;
    const std::string job = submitted.output.substr(at + 13, submitted.output.find(',', at) - at - 13);
    ASSERT_TRUE(LocalSlurm::wait_until([&] { return processes_of(job).size() >= 8; })); // four scripts, four stages
    EXPECT_THAT(submit().output, HasSubstr("still in the queue"));
    for (const int pid : processes_of(job))
        ::kill(pid, SIGKILL);
    ASSERT_TRUE(slurm_->wait_for_jobs()) << slurm_->call("squeue");
    EXPECT_THAT(status(), HasSubstr("4 failed"));
    submit_and_wait();
    EXPECT_EQ(shop_.digests("results"), digests_of_run()) << logs();
}

TEST_F(SlurmTest, TwoNodesOnOneStoreComputeEachKeyOnce)
{
    for (const std::string node : {"n1", "n2"}) {
        const CommandResult emitted = quoin(
            "emit" + options("--mode chain -S small.pause=0.3 -S large.pause=0.3 --sbatch --nodelist=" + node, node));
        ASSERT_EQ(emitted.exit_code, 0) << emitted.output;
    }
    const CommandResult submitted = shell("n1/.slurm/submit.sh && n2/.slurm/submit.sh");
    ASSERT_EQ(submitted.exit_code, 0) << submitted.output;
    ASSERT_TRUE(slurm_->wait_for_jobs()) << slurm_->call("squeue");
    const Digests digests = digests_of_run();
    EXPECT_EQ(shop_.digests("n1"), digests);
    EXPECT_EQ(shop_.digests("n2"), digests);
    std::size_t computed = 0;
    for (const char* node : {"n1", "n2"})
        for (const auto& entry : fs::recursive_directory_iterator(shop_ / node))
            if (entry.path().filename() == "record.json") computed += read_run_record(entry.path())->cached ? 0 : 1;
    EXPECT_EQ(computed, digests.size());
    EXPECT_THAT(status("n1"), HasSubstr("4 in the store"));
}

TEST_F(SlurmTest, AnElementTrustsTheStoreAndNotTheScheduler)
{
    ASSERT_EQ(quoin("emit" + options()).exit_code, 0);
    // A job that Slurm does not know counts as done.
    const CommandResult sent = shell("sbatch --wait --array=0 --dependency=aftercorr:99999 results/.slurm/02-small.sh");
    EXPECT_EQ(sent.exit_code, 3) << sent.output;
    EXPECT_THAT(logs(), HasSubstr("the result of 'read', which this stage reads, is not in the store"));
}

TEST_F(SlurmTest, SubmitsNothingWhenTheClusterCannotRunIt)
{
    const CommandResult refused = submit("", 64);
    EXPECT_NE(refused.exit_code, 0);
    EXPECT_THAT(refused.output, HasSubstr("submit.sh: Slurm refuses 01-read.sh:"));
    EXPECT_FALSE(fs::exists(shop_ / "results/.slurm/jobs.tsv"));
    EXPECT_THAT(submit("--sbatch --partition=nowhere").output, HasSubstr("Slurm refuses 01-read.sh:"));
}

} // namespace
} // namespace quoin
