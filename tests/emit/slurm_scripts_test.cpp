// How scans become arrays, and what the scripts say where there is no Slurm. tests/slurm runs them.
#include "emit/arrays.h"
#include "emit/submission.h"
#include "support/workshop.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

using test::CommandResult;
using test::Workshop;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> names_of(const std::vector<JobArray>& arrays)
{
    std::vector<std::string> names;
    for (const auto& array : arrays)
        names.push_back(array.name + "[" + elements_text(array.elements) + "]");
    return names;
}

TEST(PlanArrays, MakesOneArrayAStageThatFollowsTheOneBefore)
{
    const auto arrays = plan_arrays({{"a", {}, {true, true, true}}, {"b", {0}, {true, true, true}}}, 1001);
    EXPECT_THAT(names_of(arrays), ElementsAre("a.1[0-2]", "b.1[0-2]"));
    EXPECT_THAT(arrays[1].follows, ElementsAre(0));
}

TEST(PlanArrays, LeavesOutWhatTheStoreHas)
{
    const auto arrays = plan_arrays({{"a", {}, {false, false}}, {"b", {0}, {false, true}}}, 1001);
    EXPECT_THAT(names_of(arrays), ElementsAre("b.1[1]"));
    EXPECT_THAT(arrays[0].follows, IsEmpty());
    EXPECT_THAT(plan_arrays({{"a", {}, {false}}}, 1001), IsEmpty());
}

TEST(PlanArrays, SplitsByWhereTheParentsAreMade)
{
    // b of scan 1 waits for a; c reads a and b.
    const auto arrays = plan_arrays(
        {{"a", {}, {false, true, false}}, {"b", {0}, {true, true, false}}, {"c", {0, 1}, {true, true, true}}}, 1001);
    EXPECT_THAT(names_of(arrays), ElementsAre("a.1[1]", "b.1[0]", "b.2[1]", "c.1[0]", "c.2[1]", "c.3[2]"));
    EXPECT_THAT(arrays[1].follows, IsEmpty());
    EXPECT_THAT(arrays[2].follows, ElementsAre(0));
    EXPECT_THAT(arrays[3].follows, ElementsAre(1));
    EXPECT_THAT(arrays[4].follows, ElementsAre(0, 2));
    EXPECT_THAT(arrays[5].follows, IsEmpty());
}

TEST(PlanArrays, SplitsAtTheLargestArraySize)
{
    const auto arrays = plan_arrays({{"a", {}, std::vector<bool>(5, true)}, {"b", {0}, std::vector<bool>(5, true)}}, 2);
    EXPECT_THAT(names_of(arrays), ElementsAre("a.1[0-1]", "a.2[0-1]", "a.3[0]", "b.1[0-1]", "b.2[0-1]", "b.3[0]"));
    EXPECT_EQ(arrays[5].offset, 4U);
    EXPECT_THAT(arrays[5].follows, ElementsAre(2));
}

TEST(Submission, KnowsTheLastStateOfEveryElement)
{
    const auto jobs = parse_jobs("7\tread.1\t01-read.sh\t0\t0-2\n9\tread.1\t01-read.sh\t0\t1%5\n");
    const ElementStates states(jobs, parse_queue("7 0 COMPLETED\n7 1 FAILED\n9 1 RUNNING\n"));
    EXPECT_EQ(states.of("read", 1).text, "running");
    EXPECT_EQ(states.of("read", 1).log, "quoin-read.9_1.log");
    EXPECT_TRUE(states.of("read", 2).has_ended); // Slurm has forgotten it
    EXPECT_EQ(states.of("read", 3).text, "not submitted");
}

TEST(SlurmScripts, ArePlainBashAndSayThatThereIsNoSlurm)
{
    const Workshop shop({"a", "it's b"});
    const CommandResult emitted = shop.quoin("emit slurm p.yaml --scan scans/a --scan \"b=scans/it's b\" --to jobs");
    ASSERT_EQ(emitted.exit_code, 0) << emitted.output;
    EXPECT_EQ(emitted.output, "jobs/submit.sh\n");
    EXPECT_EQ(shop.shell("for f in jobs/*.sh; do bash -n $f || exit 1; done").exit_code, 0);
    const CommandResult alone = shop.shell("mkdir bin && ln -s $(command -v dirname) $(command -v mkdir) bin && "
                                           "PATH=$PWD/bin /bin/bash jobs/submit.sh");
    EXPECT_EQ(alone.exit_code, 1);
    EXPECT_THAT(alone.output, HasSubstr("there is no sbatch here: take this folder to a machine that has Slurm"));
}

// What an element does, without Slurm: the numbers come from the environment.
TEST(SlurmScripts, RunAsElementsAnywhere)
{
    const Workshop shop({"a", "it's b"});
    ASSERT_EQ(shop.quoin("emit slurm p.yaml --scan scans/a --scan \"b=scans/it's b\" --to jobs --out made --mode chain")
                  .exit_code,
              0);
    for (const std::string element : {"0", "1"}) {
        const CommandResult run = shop.shell("SLURM_ARRAY_TASK_ID=" + element + " bash jobs/chain.sh");
        EXPECT_EQ(run.exit_code, 0) << run.output;
    }
    ASSERT_EQ(shop.quoin("run p.yaml --scan scans/a --scan \"b=scans/it's b\" --out run").exit_code, 0);
    EXPECT_EQ(shop.digests("made"), shop.digests("run"));
    EXPECT_THAT(shop.shell("SLURM_ARRAY_TASK_ID=7 bash jobs/chain.sh").output, HasSubstr("has no scan 7"));
}

} // namespace
} // namespace quoin
