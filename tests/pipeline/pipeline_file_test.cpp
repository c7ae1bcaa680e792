#include "pipeline/pipeline_file.h"

#include "base/error.h"
#include "pipeline/fake_stages.h"

#include <fstream>
#include <gmock/gmock.h>

namespace quoin {
namespace {

using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

std::string problems_of(const std::string& text)
{
    Problems problems;
    parse_pipeline("p.yaml", text, problems);
    return problems.text();
}

std::filesystem::path write(const TemporaryFolder& folder, const std::string& name, const std::string& text)
{
    std::ofstream(folder.path() / name) << text;
    return folder.path() / name;
}

TEST(PipelineFile, HoldsStagesWiresAndParameters)
{
    Problems problems;
    Pipeline pipeline = parse_pipeline("p.yaml",
                                       "version: 1\nstages:\n  a: {use: import, in: {folder: $scan}}\n"
                                       "  b: {use: fuse, in: {scan: a.scan}, params: {size: 0.1}}\n",
                                       problems);
    ASSERT_TRUE(problems.empty()) << problems.text();
    EXPECT_THAT(pipeline.stage_names(), ElementsAre("a", "b"));
    EXPECT_EQ(pipeline.find("a")->inputs.at("folder").stage, "");
    EXPECT_EQ(pipeline.find("b")->inputs.at("scan").stage, "a");
    EXPECT_EQ(pipeline.find("b")->params.at("size").text, "0.1");
}

TEST(PipelineFile, AsksForAVersionThatItReads)
{
    EXPECT_THAT(problems_of("stages: {a: {use: x}}\n"),
                HasSubstr("does not say its version; this build reads 'version: 1'"));
    EXPECT_THAT(problems_of("version: 7\nstages: {a: {use: x}}\n"),
                HasSubstr("p.yaml:1:10: version '7' of the pipeline format"));
}

TEST(PipelineFile, RefusesUnknownKeysEverywhere)
{
    EXPECT_THAT(problems_of("version: 1\nstage: {}\n"),
                HasSubstr("p.yaml:2:1: a pipeline has no key 'stage'; did you mean 'stages'?"));
    EXPECT_THAT(problems_of("version: 1\nstages: {a: {use: x, parms: {}}}\n"),
                HasSubstr("a stage has no key 'parms'; did you mean 'params'?"));
}

TEST(PipelineFile, RefusesWhatIsNoMap)
{
    EXPECT_THAT(problems_of("- a\n- b\n"), HasSubstr("a pipeline is expected to be a map"));
    EXPECT_THAT(problems_of("version: 1\nstages: [a]\n"), HasSubstr("'stages' is expected to be a map"));
    EXPECT_THAT(problems_of("version: 1\nstages: {a: import}\n"), HasSubstr("stage 'a' is expected to be a map"));
    EXPECT_THAT(problems_of("version: 1\n"), HasSubstr("the pipeline has no stages"));
    EXPECT_THAT(problems_of(""), HasSubstr("a pipeline is expected to be a map"));
}

TEST(PipelineFile, RefusesWiresThatAreNoWires)
{
    EXPECT_THAT(problems_of("version: 1\nstages: {a: {use: x, in: {scan: b}}}\n"),
                HasSubstr("input 'scan' of stage 'a' is expected to come from stage.port or $scan"));
    EXPECT_THAT(problems_of("version: 1\nstages: {a: {in: {}}}\n"),
                HasSubstr("stage 'a' does not say which stage it uses"));
    EXPECT_THAT(problems_of("version: 1\nstages: {../a: {use: x}}\n"), HasSubstr("'../a' cannot name a stage"));
}

TEST(PipelineFile, IsLaidOverTheOneThatItExtends)
{
    const TemporaryFolder folder;
    write(folder, "base.yaml",
          "version: 1\nstages:\n  a: {use: x, params: {n: 1, m: 2}}\n  b: {use: y, in: {scan: a.scan, lines: "
          "a.lines}}\n  c: {use: z}\n");
    const auto path =
        write(folder, "mine.yaml",
              "version: 1\nextends: base.yaml\nstages:\n  a: {params: {n: 5}}\n  b: {in: {lines: null}}\n  c: null\n");
    Problems problems;
    Pipeline pipeline = read_pipeline(path, problems);
    ASSERT_TRUE(problems.empty()) << problems.text();
    EXPECT_EQ(pipeline.name, "mine");
    EXPECT_THAT(pipeline.stage_names(), ElementsAre("a", "b"));
    EXPECT_EQ(pipeline.find("a")->params.at("n").text, "5");
    EXPECT_EQ(pipeline.find("a")->params.at("m").text, "2");
    EXPECT_FALSE(pipeline.find("b")->inputs.contains("lines"));
}

TEST(PipelineFile, RefusesACircleOfExtensions)
{
    const TemporaryFolder folder;
    const auto path = write(folder, "a.yaml", "version: 1\nextends: a.yaml\nstages: {a: {use: x}}\n");
    Problems problems;
    read_pipeline(path, problems);
    EXPECT_THAT(problems.text(), HasSubstr("extend each other in a circle"));
}

TEST(PipelineFile, TakesParameterSets)
{
    const TemporaryFolder folder;
    const auto path = write(folder, "fast.yaml", "fuse: {size: 0.02}\nfused: {size: 1}\n");
    Problems problems;
    Pipeline pipeline = parse_pipeline("p.yaml", "version: 1\nstages: {fuse: {use: fuse}}\n", problems);
    apply_config(pipeline, path, problems);
    EXPECT_EQ(pipeline.find("fuse")->params.at("size").text, "0.02");
    EXPECT_THAT(problems.text(), HasSubstr("fast.yaml:2:1: the pipeline has no stage 'fused'; did you mean 'fuse'?"));
}

TEST(PipelineFile, SwapsTheProgramOfAStage)
{
    Problems problems;
    Pipeline pipeline = parse_pipeline("p.yaml", "version: 1\nstages: {fuse: {use: fuse}}\n", problems);
    apply_use(pipeline, "fuse=./mine", problems);
    EXPECT_EQ(pipeline.find("fuse")->use, "./mine");
    apply_use(pipeline, "fuze=./mine", problems);
    EXPECT_THAT(problems.text(), HasSubstr("--use: the pipeline has no stage 'fuze'; did you mean 'fuse'?"));
}

TEST(PipelineFile, SaysThatAFileIsMissing)
{
    Problems problems;
    EXPECT_THROW(read_pipeline("/nowhere/p.yaml", problems), UsageError);
}

} // namespace
} // namespace quoin
