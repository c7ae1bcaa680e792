#include "pipeline/plan.h"

#include "base/error.h"
#include "pipeline/fake_stages.h"
#include "pipeline/pipeline_file.h"

#include <fstream>
#include <gmock/gmock.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using test::FakeStages;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::IsEmpty;

class PlanTest : public testing::Test {
protected:
    PlanTest()
        : stages_({{"import", {"folder"}, {"scan"}}, {"fuse", {"scan"}, {"mesh"}}, {"export", {"mesh"}, {"model"}}})
    {
        Problems problems;
        const Pipeline pipeline = parse_pipeline("p.yaml",
                                                 "version: 1\nstages:\n  import: {use: import, in: {folder: $scan}}\n"
                                                 "  fuse: {use: fuse, in: {scan: import.scan}, params: {size: 1e-1}}\n"
                                                 "  export: {use: export, in: {mesh: fuse.mesh}}\n",
                                                 problems);
        Catalogue catalogue(stages_.folder());
        graph_ = build_graph(pipeline, catalogue, std::move(problems));
        layout_ = {folder_.path() / "out", folder_.path() / "out" / ".store"};
    }

    std::vector<Task> plan(const Selection& selection, const std::vector<NamedScan>& scans = {{"room", "/scans/room"}})
    {
        return plan_tasks(graph_, scans, layout_, selection);
    }

    static std::vector<std::string> stages_of(const std::vector<Task>& tasks)
    {
        std::vector<std::string> stages;
        for (const auto& task : tasks)
            stages.push_back(task.stage);
        return stages;
    }

    FakeStages stages_;
    TemporaryFolder folder_;
    Graph graph_;
    Layout layout_;
};

TEST_F(PlanTest, PlacesOutputsByScanStageAndPort)
{
    const auto tasks = plan({});
    const fs::path out = layout_.out;
    EXPECT_EQ(tasks[0].inputs[0].path, "/scans/room");
    EXPECT_EQ(tasks[1].inputs[0].path, out / "room/import/scan.safetensors");
    EXPECT_EQ(tasks[1].outputs[0].path, out / "room/fuse/mesh.safetensors");
    EXPECT_EQ(tasks[2].outputs[0].path, out / "room/model");
    EXPECT_THAT(tasks[1].settings, ElementsAre("size=0.1"));
}

TEST_F(PlanTest, WaitsForTheTasksOfTheSameScan)
{
    const auto tasks = plan({}, {{"a", "/scans/a"}, {"b", "/scans/b"}});
    ASSERT_EQ(tasks.size(), 6U);
    EXPECT_THAT(tasks[0].after, IsEmpty());
    EXPECT_THAT(tasks[4].after, ElementsAre(3));
    EXPECT_THAT(tasks[5].after, ElementsAre(4));
}

TEST_F(PlanTest, EndsAtUntil)
{
    EXPECT_THAT(stages_of(plan({.from = {}, .until = "fuse", .force = {}})), ElementsAre("import", "fuse"));
}

TEST_F(PlanTest, BeginsAtFromWhenEarlierResultsAreThere)
{
    EXPECT_THROW(plan({.from = "fuse", .until = {}, .force = {}}), InputError);
    fs::create_directories(layout_.out / "room/import");
    std::ofstream(layout_.out / "room/import/scan.safetensors") << "x";
    const auto tasks = plan({.from = "fuse", .until = {}, .force = {}});
    EXPECT_THAT(stages_of(tasks), ElementsAre("fuse", "export"));
    EXPECT_THAT(tasks[0].after, IsEmpty());
}

TEST_F(PlanTest, ForcesOnlyTheNamedStage)
{
    const auto tasks = plan({.from = {}, .until = {}, .force = {"fuse"}});
    EXPECT_FALSE(tasks[0].is_forced);
    EXPECT_TRUE(tasks[1].is_forced);
}

TEST_F(PlanTest, LetsEqualTasksWaitForTheFirst)
{
    auto tasks = plan({}, {{"a", "/scans/room"}, {"b", "/scans/room"}});
    tasks[4].settings = {"size=0.3"};
    wait_for_equal_tasks(tasks);
    EXPECT_THAT(tasks[3].after, ElementsAre(0)); // the same import
    EXPECT_THAT(tasks[4].after, ElementsAre(3)); // another size: its own work
    EXPECT_THAT(tasks[5].after, ElementsAre(4)); // and so is what reads it
}

TEST_F(PlanTest, RefusesUnknownStages)
{
    EXPECT_THROW(plan({.from = "fuze", .until = {}, .force = {}}), UsageError);
    EXPECT_THROW(plan({.from = {}, .until = "fuze", .force = {}}), UsageError);
    EXPECT_THROW(plan({.from = {}, .until = {}, .force = {"fuze"}}), UsageError);
    EXPECT_THROW(plan({.from = "export", .until = "import", .force = {}}), UsageError);
}

TEST_F(PlanTest, NamesScansAfterTheirFolders)
{
    fs::create_directories(folder_.path() / "kitchen");
    const std::string folder = (folder_.path() / "kitchen").string();
    EXPECT_EQ(parse_scans({folder + "/"})[0].name, "kitchen");
    EXPECT_EQ(parse_scans({"k=" + folder})[0].name, "k");
    EXPECT_THROW(parse_scans({folder, folder}), UsageError);
    EXPECT_THROW(parse_scans({folder + "/nothing"}), InputError);
}

} // namespace
} // namespace quoin
