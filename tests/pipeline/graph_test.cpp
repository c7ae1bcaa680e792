#include "pipeline/graph.h"

#include "base/error.h"
#include "pipeline/fake_stages.h"
#include "pipeline/graph_text.h"
#include "pipeline/pipeline_file.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

using test::FakeStages;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const FakeStages& stages()
{
    static const FakeStages fakes({{"import", {"folder"}, {"scan"}},
                                   {"fuse", {"scan"}, {"mesh"}},
                                   {"partition", {"mesh"}, {"plane_mesh"}},
                                   {"merge", {"plane_mesh"}, {"plane_mesh"}},
                                   {"bake", {"scan", "plane_mesh", "?lines"}, {"textured_mesh"}},
                                   {"newer", {"mesh:mesh/2"}, {"mesh:mesh/2"}},
                                   {"newest", {"mesh:mesh/3"}, {"mesh:mesh/3"}}});
    return fakes;
}

constexpr const char* kStart = "version: 1\nstages:\n  import: {use: import, in: {folder: $scan}}\n";

Graph graph_of(const std::string& stage_lines, const std::vector<std::string>& settings = {})
{
    Problems problems;
    Pipeline pipeline = parse_pipeline("p.yaml", kStart + stage_lines, problems);
    for (const auto& setting : settings)
        apply_setting(pipeline, setting, problems);
    Catalogue catalogue(stages().folder());
    return build_graph(pipeline, catalogue, std::move(problems));
}

// Everything that is said against the pipeline.
std::string refusal(const std::string& stage_lines, const std::vector<std::string>& settings = {})
{
    try {
        graph_of(stage_lines, settings);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "nothing";
}

std::vector<std::string> names(const Graph& graph)
{
    std::vector<std::string> names;
    for (const auto& node : graph.nodes)
        names.push_back(node.name);
    return names;
}

TEST(Graph, PutsStagesIntoRunningOrderWhateverTheirOrderInTheFile)
{
    const Graph graph = graph_of(
        "  partition: {use: partition, in: {mesh: fuse.mesh}}\n  fuse: {use: fuse, in: {scan: import.scan}}\n");
    EXPECT_THAT(names(graph), ElementsAre("import", "fuse", "partition"));
}

TEST(Graph, NamesTheNearestStageForAMistypedOne)
{
    EXPECT_EQ(refusal("  fuse: {use: fusse, in: {scan: import.scan}}\n"),
              "p.yaml:4:15: there is no stage 'fusse'; did you mean 'fuse'?\n"
              "  4 |   fuse: {use: fusse, in: {scan: import.scan}}\n"
              "    |               ^");
}

TEST(Graph, NamesTheNearestStageForAMistypedWire)
{
    EXPECT_THAT(refusal("  fuse: {use: fuse, in: {scan: imprt.scan}}\n"),
                HasSubstr("p.yaml:4:32: the pipeline has no stage 'imprt'; did you mean 'import'?"));
}

TEST(Graph, NamesTheOutputsOfAStageForAWrongPort)
{
    EXPECT_THAT(refusal("  fuse: {use: fuse, in: {scan: import.mesh}}\n"),
                HasSubstr("p.yaml:4:32: stage 'import' has no output 'mesh'; there is: scan"));
}

TEST(Graph, RefusesAnUnknownInput)
{
    EXPECT_THAT(refusal("  fuse: {use: fuse, in: {scan: import.scan, scann: import.scan}}\n"),
                HasSubstr("p.yaml:4:45: stage 'fuse' has no input 'scann'; did you mean 'scan'?"));
}

TEST(Graph, RefusesAWireBetweenDifferentSchemas)
{
    EXPECT_THAT(refusal("  partition: {use: partition, in: {mesh: import.scan}}\n"),
                HasSubstr("p.yaml:4:42: 'import.scan' is a scan/1, but input 'mesh' takes a mesh/1"));
}

TEST(Graph, AcceptsTheVersionBeforeAndNoOlderOne)
{
    const std::string fuse = "  fuse: {use: fuse, in: {scan: import.scan}}\n";
    EXPECT_EQ(refusal(fuse + "  newer: {use: newer, in: {mesh: fuse.mesh}}\n"), "nothing");
    EXPECT_THAT(refusal(fuse + "  newest: {use: newest, in: {mesh: fuse.mesh}}\n"),
                HasSubstr("is a mesh/1, but input 'mesh' takes a mesh/3"));
}

TEST(Graph, RefusesTheScanFolderWhereAnArtifactIsRead)
{
    EXPECT_THAT(refusal("  fuse: {use: fuse, in: {scan: $scan}}\n"),
                HasSubstr("p.yaml:4:32: $scan is a folder, but input 'scan' takes a scan/1"));
}

TEST(Graph, AsksForRequiredInputsAndNotForOptionalOnes)
{
    EXPECT_THAT(refusal("  bake: {use: bake, in: {scan: import.scan}}\n"),
                AllOf(HasSubstr("p.yaml:4:3: input 'plane_mesh' of stage 'bake' is not wired; it takes a plane_mesh/1"),
                      Not(HasSubstr("lines"))));
}

TEST(Graph, ShowsACircle)
{
    const std::string message =
        refusal("  a: {use: merge, in: {plane_mesh: b.plane_mesh}}\n  b: {use: merge, in: {plane_mesh: a.plane_mesh}}\n"
                "  c: {use: merge, in: {plane_mesh: b.plane_mesh}}\n");
    EXPECT_THAT(message, HasSubstr("stages wait for each other: a -> b -> a"));
}

TEST(Graph, NamesTheNearestParameter)
{
    EXPECT_THAT(refusal("  fuse: {use: fuse, in: {scan: import.scan}, params: {sizes: 0.1}}\n"),
                HasSubstr("p.yaml:4:55: stage 'fuse' has no parameter 'sizes'; did you mean 'size'?"));
}

TEST(Graph, RefusesValuesOfAnotherTypeOrOutsideTheInterval)
{
    const auto with = [](const std::string& params) {
        return refusal("  fuse: {use: fuse, in: {scan: import.scan}, params: {" + params + "}}\n");
    };
    EXPECT_THAT(
        with("size: 2"),
        HasSubstr("p.yaml:4:61: stage 'fuse': parameter 'size' is '2': expected a finite number from 0 to 1 m"));
    EXPECT_THAT(with("size: wide"), HasSubstr("expected a number from 0 to 1 m"));
    EXPECT_THAT(with("size: .nan"), HasSubstr("expected a number"));
    EXPECT_THAT(with("count: 1.5"), HasSubstr("expected a whole number"));
    EXPECT_THAT(with("mode: slow"), HasSubstr("expected one of fast, exact"));
    EXPECT_THAT(with("flag: yes"), HasSubstr("expected true or false"));
    EXPECT_THAT(with("size: [1, 2]"), HasSubstr("parameter 'size' takes one value"));
}

TEST(Graph, ReportsEverythingAtOnceInTheOrderOfTheFile)
{
    const std::string message = refusal("  fuse: {use: fuse, in: {scan: imprt.scan}, params: {sizes: 1}}\n"
                                        "  partition: {use: partition, im: {mesh: fuse.mesh}}\n");
    const std::vector<std::string> expected{
        "p.yaml:4:32:", "p.yaml:4:54:", "p.yaml:5:3:", "p.yaml:5:31: a stage has no key 'im'; did you mean 'in'?"};
    std::size_t at = 0;
    for (const auto& text : expected) {
        at = message.find(text, at);
        EXPECT_NE(at, std::string::npos) << text << " in\n" << message;
    }
}

TEST(Graph, BlamesTheCommandLineForItsSettings)
{
    const std::string fuse = "  fuse: {use: fuse, in: {scan: import.scan}}\n";
    EXPECT_EQ(refusal(fuse, {"fuse.sizes=1"}),
              "-S: stage 'fuse' has no parameter 'sizes'; did you mean 'size'?\n   | fuse.sizes=1\n   |      ^");
    EXPECT_THAT(refusal(fuse, {"fuze.size=1"}),
                HasSubstr("-S: the pipeline has no stage 'fuze'; did you mean 'fuse'?"));
    EXPECT_THAT(refusal(fuse, {"fuse"}), HasSubstr("-S: expected stage.param=value"));
}

TEST(Graph, LaysSettingsOverTheFile)
{
    const Graph graph =
        graph_of("  fuse: {use: fuse, in: {scan: import.scan}, params: {size: 0.1, count: 7}}\n", {"fuse.size=0.2"});
    ASSERT_EQ(graph.nodes[1].params.size(), 2U);
    EXPECT_EQ(std::get<std::int64_t>(graph.nodes[1].params[0].value), 7);
    EXPECT_EQ(std::get<double>(graph.nodes[1].params[1].value), 0.2);
}

TEST(Graph, FindsTheFolderOfTheImagesBehindTheScan)
{
    const Graph graph = graph_of(
        "  fuse: {use: fuse, in: {scan: import.scan}}\n  partition: {use: partition, in: {mesh: fuse.mesh}}\n");
    const GraphInput* folder = graph.scan_folder(2);
    ASSERT_NE(folder, nullptr);
    EXPECT_EQ(folder->port, "folder");
    EXPECT_FALSE(folder->from.has_value());
}

TEST(Graph, IsDrawnAsTextDotAndMermaid)
{
    const Graph graph = graph_of("  room: {use: fuse, in: {scan: import.scan}}\n");
    EXPECT_EQ(graph_as_text(graph), "import       $scan -> scan\nroom (fuse)  import.scan -> mesh\n");
    EXPECT_THAT(graph_as_dot(graph), HasSubstr("\"import\" -> \"room\" [label=\"scan\"];"));
    EXPECT_THAT(graph_as_mermaid(graph), HasSubstr("  s0 -- scan --> s1\n"));
}

TEST(Graph, IsColouredByWhatTheStoreHas)
{
    const Graph graph = graph_of("  room: {use: fuse, in: {scan: import.scan}}\n");
    const std::vector<NodeState> one{{.stored = 1}, {.compute = 1}};
    EXPECT_EQ(graph_as_text(graph, one), "import       in the store  $scan -> scan\n"
                                         "room (fuse)  to compute    import.scan -> mesh\n");
    EXPECT_THAT(graph_as_text(graph, one, true), HasSubstr("\x1b[32min the store"));
    EXPECT_THAT(graph_as_dot(graph, one),
                HasSubstr(R"("room" [label="room (fuse)\nto compute", fillcolor="#f8cfc4"])"));
    EXPECT_THAT(graph_as_mermaid(graph, one), HasSubstr("s0[\"import<br>in the store\"]:::stored\n"));
    EXPECT_THAT(graph_as_text(graph, {{.compute = 1}, {.follows = 1}}), HasSubstr("room (fuse)  follows     import"));
    const std::vector<NodeState> many{{.stored = 9}, {.stored = 5, .compute = 0, .follows = 4}};
    EXPECT_THAT(graph_as_text(graph, many), HasSubstr("5 in the store, 4 follow"));
}

TEST(Graph, RefusesAProgramThatIsNoStage)
{
    EXPECT_THAT(refusal("  fuse: {use: /bin/true, in: {scan: import.scan}}\n"),
                HasSubstr("p.yaml:4:15: /bin/true: what it says about itself"));
    EXPECT_THAT(refusal("  fuse: {use: /bin/false, in: {scan: import.scan}}\n"),
                HasSubstr("/bin/false: ended with exit code 1 on --describe"));
    EXPECT_THAT(refusal("  fuse: {use: ./nothing, in: {scan: import.scan}}\n"), HasSubstr("no such program"));
}

} // namespace
} // namespace quoin
