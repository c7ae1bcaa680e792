#include "pipeline/study.h"

#include "pipeline/pipeline_file.h"

#include "support/temporary_folder.h"
#include <fstream>
#include <gmock/gmock.h>

namespace quoin {
namespace {

using testing::ElementsAre;

constexpr const char* kStages = R"(version: 1
stages:
  mesh: {use: fuse, in: {scan: $scan}, params: {size: 0.1}}
  planes: {use: partition, in: {mesh: mesh.mesh}}
  merge: {use: merge, in: {plane_mesh: planes.plane_mesh}}
  lines: {use: lines, in: {plane_mesh: merge.plane_mesh}}
  bake: {use: bake, in: {plane_mesh: merge.plane_mesh, lines: lines.lines}}
)";

Study study_of(const std::string& text, const StudyArguments& arguments = {})
{
    Problems problems;
    const Pipeline pipeline = parse_pipeline("p.yaml", kStages + text, problems);
    Study study = make_study(pipeline, arguments, problems);
    EXPECT_EQ(problems.text(), "");
    return study;
}

std::vector<std::string> names(const Study& study)
{
    std::vector<std::string> names;
    for (const auto& variant : study.variants)
        names.push_back(variant.name);
    return names;
}

std::string param(Study& study, std::size_t variant, const std::string& stage, const std::string& name)
{
    const auto& params = study.variants.at(variant).pipeline.find(stage)->params;
    return params.contains(name) ? params.at(name).text : "";
}

TEST(Study, HasTheBaselineFirstAndEveryVariant)
{
    Study study = study_of("variants:\n  coarse: {mesh: {params: {size: 0.2}}}\n  fine: {mesh.size: 0.01}\n");
    EXPECT_THAT(names(study), ElementsAre("baseline", "coarse", "fine"));
    EXPECT_EQ(param(study, 0, "mesh", "size"), "0.1");
    EXPECT_EQ(param(study, 1, "mesh", "size"), "0.2");
    EXPECT_EQ(param(study, 2, "mesh", "size"), "0.01");
}

TEST(Study, RemovesAStageAndItsWires)
{
    Study study = study_of("variants: {no-lines: {remove: [lines]}}\n");
    Pipeline& pipeline = study.variants[1].pipeline;
    EXPECT_EQ(pipeline.find("lines"), nullptr);
    EXPECT_FALSE(pipeline.find("bake")->inputs.contains("lines"));
}

TEST(Study, LeadsWiresPastARemovedStageThatPassesItsInputOn)
{
    Study study = study_of("variants: {no-merge: {remove: merge}}\n");
    EXPECT_EQ(study.variants[1].pipeline.find("bake")->inputs.at("plane_mesh").stage, "planes");
    EXPECT_EQ(study.variants[1].pipeline.find("lines")->inputs.at("plane_mesh").stage, "planes");
}

TEST(Study, TakesEveryCombinationOfAMatrixButTheExcludedOnes)
{
    Study study = study_of("matrix:\n  mesh.size: [0.1, 0.2]\n  merge.angle: [5, 10]\n"
                           "  exclude: [{mesh.size: 0.2, merge.angle: 5}]\n  include: [{planes.method: heap}]\n");
    EXPECT_THAT(names(study), ElementsAre("baseline", "mesh.size=0.1,merge.angle=5", "mesh.size=0.1,merge.angle=10",
                                          "mesh.size=0.2,merge.angle=10", "planes.method=heap"));
    EXPECT_EQ(param(study, 3, "mesh", "size"), "0.2");
    EXPECT_EQ(param(study, 3, "merge", "angle"), "10");
}

TEST(Study, ChangesOneThingAtATimeAroundItsBaseline)
{
    Study study = study_of("variants: {no-lines: {remove: [lines]}, unused: {mesh.size: 9}}\n"
                           "ablate:\n  baseline: {merge.angle: 7}\n"
                           "  one_at_a_time: {mesh.size: [0.1, 0.3], merge.use: [./mine], variant: [no-lines]}\n");
    EXPECT_THAT(names(study),
                ElementsAre("baseline", "mesh.size=0.1", "mesh.size=0.3", "merge.use=._mine", "no-lines"));
    for (std::size_t i = 0; i < study.variants.size(); ++i)
        EXPECT_EQ(param(study, i, "merge", "angle"), "7");
    EXPECT_EQ(param(study, 2, "mesh", "size"), "0.3");
    EXPECT_EQ(study.variants[3].pipeline.find("merge")->use, "./mine");
}

TEST(Study, TakesAxesFromTheCommandLine)
{
    const Study study =
        study_of("variants: {no-lines: {remove: [lines]}}\n",
                 {.vary = {"mesh.size=1,2"}, .matrix = {"merge.angle=3", "variant=no-lines"}, .only = {}});
    EXPECT_THAT(names(study),
                ElementsAre("baseline", "no-lines", "mesh.size=1", "mesh.size=2", "merge.angle=3,no-lines"));
}

TEST(Study, KeepsTheVariantsThatAreAskedFor)
{
    const Study study =
        study_of("matrix: {mesh.size: [1, 2, 3]}\n", {.vary = {}, .matrix = {}, .only = {"mesh.size=2"}});
    EXPECT_THAT(names(study), ElementsAre("baseline", "mesh.size=2"));
}

TEST(Study, LaysParameterSetsOver)
{
    const test::TemporaryFolder folder;
    std::ofstream(folder / "coarse.yaml") << "mesh: {size: 0.5}\n";
    Problems problems;
    const Pipeline pipeline =
        parse_pipeline(folder / "p.yaml", std::string(kStages) + "variants: {c: {config: coarse.yaml}}\n", problems);
    Study study = make_study(pipeline, {}, problems);
    EXPECT_EQ(problems.text(), "");
    EXPECT_EQ(param(study, 1, "mesh", "size"), "0.5");
    EXPECT_EQ(make_variant(pipeline, "c", problems).find("mesh")->params.at("size").text, "0.5");
}

TEST(Study, TakesOverWhatTheExtendedPipelineSays)
{
    const test::TemporaryFolder folder;
    std::ofstream(folder / "base.yaml") << kStages << "variants: {a: {mesh.size: 1}, b: {mesh.size: 2}}\n"
                                        << "matrix: {mesh.size: [5]}\nreport: {metrics: [x]}\n";
    std::ofstream(folder / "p.yaml") << "version: 1\nextends: base.yaml\nvariants: {a: null, c: {mesh.size: 3}}\n"
                                     << "matrix: null\n";
    Problems problems;
    const Study study = make_study(read_pipeline(folder / "p.yaml", problems), {}, problems);
    EXPECT_EQ(problems.text(), "");
    EXPECT_THAT(names(study), ElementsAre("baseline", "b", "c"));
    EXPECT_THAT(study.metrics, ElementsAre("x"));
}

} // namespace
} // namespace quoin
