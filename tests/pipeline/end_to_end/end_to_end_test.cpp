// The whole data path on a small synthetic room, by the driver and by make.
#include "artifact/artifact.h"
#include "base/atomic_file.h"
#include "build_paths.h"
#include "pipeline/catalogue.h"
#include "pipeline/graph.h"
#include "pipeline/pipeline_file.h"
#include "pipeline/plan.h"
#include "pipeline/run_record.h"
#include "pipeline/task_keys.h"
#include "support/command.h"
#include "support/temporary_folder.h"

#include <fstream>
#include <gmock/gmock.h>
#include <map>
#include <memory>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::TemporaryFolder;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

const std::string kBin = QUOIN_BINARY_DIR "/bin";

// Payloads by "stage.port".
using Digests = std::map<std::string, std::string>;

Digests digests_of(const fs::path& scan_folder)
{
    Digests digests;
    for (const auto& entry : fs::directory_iterator(scan_folder))
        if (const auto record = read_run_record(entry.path() / "record.json"))
            for (const auto& [port, payload] : record->outputs)
                digests[entry.path().filename().string() + "." + port] = payload;
    return digests;
}

// A room, small enough for seconds, and the results of running the pipeline on it with one thread.
class EndToEnd : public testing::Test {
protected:
    static void SetUpTestSuite()
    {
        folder_ = std::make_unique<TemporaryFolder>();
        const CommandResult made = in_folder(
            kBin + "/synthesize --out folder=room --set frames=24 --set width=320 --set height=240 --set focal=260"
                   " --set room_width=3 --set room_length=3 --set furniture=1 --set texel_size=0.01"
                   " --set truth_samples=2000 --set truth_edge=0.5 --progress none");
        ASSERT_EQ(made.exit_code, 0) << made.output;
        const CommandResult first = run("one", 1);
        ASSERT_EQ(first.exit_code, 0) << first.output;
    }
    static void TearDownTestSuite() { folder_.reset(); }

    static CommandResult in_folder(const std::string& command)
    {
        return test::run_command("cd '" + folder_->path().string() + "' && unset QUOIN_STORE && " + command);
    }

    static CommandResult run(const std::string& out, int threads, const std::string& options = "")
    {
        return in_folder(kBin + "/quoin run --scan room --out " + out + " --threads " + std::to_string(threads) + " " +
                         options);
    }

    static fs::path path(const std::string& name) { return *folder_ / name; }

    inline static std::unique_ptr<TemporaryFolder> folder_;
};

TEST_F(EndToEnd, DriverAndStagesComputeTheSameKeys)
{
    Problems problems;
    const Pipeline pipeline = read_pipeline(QUOIN_SOURCE_DIR "/pipelines/indoor.yaml", problems);
    Catalogue catalogue(kBin);
    const Graph graph = build_graph(pipeline, catalogue, std::move(problems));
    const auto tasks = plan_tasks(graph, parse_scans({path("room")}), {path("one"), path("one/.store")}, {});
    TaskKeys keys(tasks, {});
    for (std::size_t i = 0; i < tasks.size(); ++i) {
        const auto record = read_run_record(tasks[i].record); // written by the stage
        const auto key = keys.key(i);
        ASSERT_TRUE(record && key) << tasks[i].stage;
        EXPECT_EQ(key->hex, record->key) << tasks[i].stage << ": " << key->json;
        keys.set_outputs(i, record->outputs);
    }
}

TEST_F(EndToEnd, MakesAModelWithASummaryOfEveryStage)
{
    for (const char* file :
         {"model.glb", "model.obj", "model.mtl", "model.ply", "planes.json", "trajectory.txt", "summary.json"})
        EXPECT_GT(fs::file_size(path("one/room/model") / file), 0U) << file;
    const std::string summary = read_text(path("one/room/model/summary.json"));
    for (const char* key :
         {"\"seconds\"", "\"peak_memory_bytes\"", "\"optimize-texture\"", "\"impl_version\"", "\"params\""})
        EXPECT_THAT(summary, HasSubstr(key));
}

TEST_F(EndToEnd, WritesAReportBesideTheModel)
{
    const std::string page = read_text(path("one/room/report.html"));
    for (const char* part : {"\"optimize-texture\"", "texture.photograph", "id=\"page-0-color\"",
                             "id=\"array-dense-face\"", "id=\"photograph-0\"", "id=\"array-lines\"", "model/model.glb"})
        EXPECT_THAT(page.find(part), Not(std::string::npos)) << part;
    const auto written = fs::last_write_time(path("one/room/report.html"));
    EXPECT_EQ(in_folder(kBin + "/quoin report --scan room --out one").output, "one/room/report.html\n");
    EXPECT_EQ(fs::last_write_time(path("one/room/report.html")), written) << "nothing has changed";
    const CommandResult elsewhere = in_folder(kBin + "/quoin report --scan room --out page.html --results one");
    EXPECT_EQ(elsewhere.exit_code, 0) << elsewhere.output;
    EXPECT_GT(fs::file_size(path("page.html")), 100000U);
    EXPECT_EQ(in_folder(kBin + "/quoin report --scan room --out nowhere").exit_code, 3);
}

TEST_F(EndToEnd, DrawsEveryArtifactThatHasAPicture)
{
    for (const std::string file : {"import/scan", "fuse/mesh", "select-keyframes/keyframes", "merge/plane_mesh",
                                   "detect-lines/lines", "optimize-texture/alignment", "bake-texture/textured_mesh"}) {
        const CommandResult drawn =
            in_folder(kBin + "/quoin inspect one/room/" + file + ".safetensors --picture picture.png --scan-root room");
        EXPECT_EQ(drawn.exit_code, 0) << drawn.output;
        EXPECT_GT(fs::file_size(path("picture.png")), 5000U) << file;
    }
    const std::string inspect = kBin + "/quoin inspect one/room/";
    EXPECT_EQ(in_folder(inspect + "evaluate/metrics.safetensors --picture p.png").exit_code, 2);
    EXPECT_THAT(in_folder(inspect + "detect-lines/lines.safetensors --picture p.png").output, HasSubstr("--scan-root"));
}

TEST_F(EndToEnd, FindsItsOwnPipelinesAndParameterSetsValid)
{
    for (const std::string pipeline : {"indoor", "single", "paper"})
        for (const auto& config : fs::directory_iterator(QUOIN_SOURCE_DIR "/configs")) {
            const CommandResult graph =
                in_folder(kBin + "/quoin graph " + pipeline + " --config '" + config.path().string() + "'");
            EXPECT_EQ(graph.exit_code, 0) << graph.output;
        }
}

TEST_F(EndToEnd, GivesTheSameBytesForAnyNumberOfThreads)
{
    const Digests one = digests_of(path("one/room"));
    EXPECT_GE(one.size(), 13U);
    for (const int threads : {2, 4}) {
        const std::string out = "threads" + std::to_string(threads);
        const CommandResult result = run(out, threads);
        ASSERT_EQ(result.exit_code, 0) << result.output;
        EXPECT_EQ(digests_of(path(out + "/room")), one);
    }
}

TEST_F(EndToEnd, ComputesNothingTheSecondTime)
{
    const std::string summary = read_text(path("one/room/model/summary.json"));
    const CommandResult again = run("one", 2);
    EXPECT_EQ(again.exit_code, 0);
    EXPECT_THAT(again.output, AllOf(HasSubstr("nothing to compute"), Not(HasSubstr("done in"))));
    EXPECT_EQ(read_text(path("one/room/model/summary.json")), summary);
    EXPECT_THAT(run("one", 2, "--dry-run").output, HasSubstr(" 0 to compute"));
}

TEST_F(EndToEnd, GivesTheSameBytesByMake)
{
    const std::string make =
        "make -j2 -f " QUOIN_SOURCE_DIR "/Makefile.example SCAN=room OUT=made THREADS=1 BIN=" + kBin;
    const CommandResult made = in_folder(make);
    ASSERT_EQ(made.exit_code, 0) << made.output;
    const std::map<std::string, std::string> files{{"scan", "import/scan"},
                                                   {"draft.alignment", "draft-optimize-texture/alignment"},
                                                   {"corrected", "correct-poses/scan"},
                                                   {"mesh", "fuse/mesh"},
                                                   {"keyframes", "select-keyframes/keyframes"},
                                                   {"partition", "partition/plane_mesh"},
                                                   {"merge", "merge/plane_mesh"},
                                                   {"simplify", "simplify/plane_mesh"},
                                                   {"lines", "detect-lines/lines"},
                                                   {"alignment", "optimize-texture/alignment"},
                                                   {"geometry", "optimize-geometry/plane_mesh"},
                                                   {"filled", "fill-holes/plane_mesh"},
                                                   {"textured", "bake-texture/textured_mesh"},
                                                   {"metrics", "evaluate/metrics"}};
    for (const auto& [by_make, by_driver] : files)
        EXPECT_EQ(read_artifact_header(path("made/" + by_make + ".safetensors")).payload,
                  read_artifact_header(path("one/room/" + by_driver + ".safetensors")).payload)
            << by_make;
    EXPECT_EQ(read_text(path("made/model/model.glb")), read_text(path("one/room/model/model.glb")));
    EXPECT_THAT(in_folder(make).output, HasSubstr("Nothing to be done"));
}

TEST_F(EndToEnd, GivesTheSameBytesByAnEmittedNinjaFile)
{
    const CommandResult emitted =
        in_folder(kBin + "/quoin emit ninja indoor --scan room --out ninja --to build.ninja && ninja -j2");
    ASSERT_EQ(emitted.exit_code, 0) << emitted.output;
    EXPECT_EQ(digests_of(path("ninja/room")), digests_of(path("one/room")));
    EXPECT_THAT(in_folder("ninja").output, HasSubstr("no work to do"));
}

TEST_F(EndToEnd, TakesAStageInPythonInThePlaceOfMerge)
{
    if (in_folder("PATH=/usr/bin:$PATH python3 -c 'import numpy'").exit_code != 0)
        GTEST_SKIP() << "python3 with numpy is not installed (package python3-numpy)";
    const CommandResult swapped = in_folder(
        "export PATH=/usr/bin:$PATH; " + kBin +
        "/quoin run --scan room --out swapped --store one/.store --until simplify --use merge=" QUOIN_SOURCE_DIR
        "/docs/examples/merge-by-normal -S merge.max_angle=10");
    ASSERT_EQ(swapped.exit_code, 0) << swapped.output;
    EXPECT_THAT(swapped.output, HasSubstr("2 stages computed")); // and all before it from the store
    const CommandResult refused = in_folder("export PATH=/usr/bin:$PATH; " + kBin +
                                            "/quoin run --scan room --out swapped --use merge=" QUOIN_SOURCE_DIR
                                            "/docs/examples/merge-by-normal -S merge.max_angel=10");
    EXPECT_THAT(refused.output, HasSubstr("did you mean 'max_angle'?"));
}

TEST_F(EndToEnd, RunsOnlyWhatAChangedParameterTouches)
{
    const CommandResult changed = run("one", 2, "--until export -S bake-texture.jpeg_quality=80");
    EXPECT_EQ(changed.exit_code, 0) << changed.output;
    EXPECT_THAT(changed.output, HasSubstr("2 stages computed"));
}

TEST_F(EndToEnd, SaysWhyAStageWouldRunDownToTheParameter)
{
    const std::string quoin = kBin + "/quoin ";
    const std::string place = " --scan room --out one -S optimize-geometry.lambda_l=7";
    const CommandResult why = in_folder(quoin + "why --stage export" + place);
    // The run before had another jpeg_quality, so there are two reasons.
    EXPECT_THAT(why.output, HasSubstr("room/export may run\n  <- textured_mesh is made by <- bake-texture may run <- "
                                      "param jpeg_quality 80 -> 92 (the stage's default)\n"));
    EXPECT_THAT(why.output, HasSubstr("<- bake-texture may run <- plane_mesh is made by <- fill-holes may run <- "
                                      "plane_mesh is made by <- optimize-geometry must run <- param lambda_l 10 -> 7 "
                                      "(-S)\n"));
    const CommandResult plan = in_folder(quoin + "plan" + place);
    EXPECT_THAT(plan.output, HasSubstr("1 to compute, 4 that follow from those\nabout "));
    EXPECT_THAT(in_folder(quoin + "graph" + place).output, ContainsRegex("optimize-geometry +to compute"));
    EXPECT_THAT(in_folder(quoin + "why --stage fuze" + place).output, HasSubstr("did you mean 'fuse'?"));
}

TEST_F(EndToEnd, SaysWhereAChangeWasCutOff)
{
    // The tolerance of a solver that is not used changes the key and nothing else.
    const std::string setting = " -S optimize-geometry.solver_tolerance=1e-9";
    const CommandResult run_again = run("cut", 2, "--store one/.store");
    ASSERT_EQ(run_again.exit_code, 0) << run_again.output;
    EXPECT_THAT(run("cut", 2, "--store one/.store" + setting).output, HasSubstr("1 stage computed"));
    const CommandResult why =
        in_folder(kBin + "/quoin why --stage bake-texture --scan room --out cut --store one/.store" + setting);
    EXPECT_THAT(why.output,
                AllOf(HasSubstr("room/bake-texture is up to date"),
                      HasSubstr("optimize-geometry ran with param solver_tolerance 1e-10 -> 1e-09 (-S), but "
                                "its plane_mesh came out the same: cut off there")));
}

TEST_F(EndToEnd, FindsTheAblationValidAndSharesItsFirstStages)
{
    const CommandResult plan = in_folder(kBin + "/quoin ablate --scan room --out variants --dry-run");
    EXPECT_EQ(plan.exit_code, 0) << plan.output;
    EXPECT_THAT(plan.output, HasSubstr("optimize-texture"));
}

TEST_F(EndToEnd, SaysWhatIsWrongWithAScanOnce)
{
    fs::create_directories(path("empty"));
    const CommandResult empty = in_folder(kBin + "/quoin run --scan empty --out bad");
    EXPECT_EQ(empty.exit_code, 3);
    EXPECT_THAT(empty.output, HasSubstr("empty"));
    EXPECT_EQ(empty.output.find("error:"), empty.output.rfind("error:"));
    EXPECT_EQ(in_folder(kBin + "/quoin run --scan nowhere --out bad").exit_code, 3);
    EXPECT_EQ(in_folder(kBin + "/quoin run --scan room --out bad -S fuse.voxel_size=-1").exit_code, 2);
}

TEST_F(EndToEnd, SaysThatAnArtifactIsDamaged)
{
    const std::string whole = read_text(path("one/room/fuse/mesh.safetensors"));
    std::ofstream(path("cut.safetensors"), std::ios::binary) << whole.substr(0, whole.size() / 2);
    const CommandResult cut = in_folder(kBin + "/partition --in mesh=cut.safetensors --out plane_mesh=p.safetensors");
    EXPECT_EQ(cut.exit_code, 3);
    EXPECT_THAT(cut.output, HasSubstr("cut.safetensors"));
    EXPECT_FALSE(fs::exists(path("p.safetensors")));
}

} // namespace
} // namespace quoin
