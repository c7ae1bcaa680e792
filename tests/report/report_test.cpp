#include "build_paths.h"
#include "report/report.h"

#include "base/atomic_file.h"
#include "image/image_io.h"
#include "report/coarsen.h"
#include "report/page_arrays.h"
#include "support/command.h"
#include "support/expect_error.h"
#include "support/plane_meshes.h"
#include "support/temporary_folder.h"

#include <fstream>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using test::TemporaryFolder;
using namespace testing_support;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

const std::string kNpm = QUOIN_SOURCE_DIR "/tests/npm";

// A room of 4 x 2.5 x 3 m (y up) seen from inside, every plane with a stripe of the page.
TexturedMesh textured_room()
{
    TexturedMesh room;
    room.planes = box({4.0, 2.5, 3.0}, 4);
    for (auto& face : room.planes.mesh.face)
        std::swap(face[1], face[2]);
    for (auto& plane : room.planes.plane)
        plane = plane.flipped();
    constexpr int kStripe = 16, kPlanes = 6;
    ColorImage page(kStripe * kPlanes, kStripe);
    for (int y = 0; y < page.height; ++y)
        for (int x = 0; x < page.width; ++x)
            page.at(x, y) = {static_cast<std::uint8_t>(40 * (x / kStripe)), 120, static_cast<std::uint8_t>(12 * y)};
    room.page.push_back(
        {page.width, page.height, encode_png(page), encode_png(Image<std::uint8_t>(page.width, page.height, 1))});
    for (const PlaneId p : room.planes.face_plane) {
        const auto first = static_cast<std::uint32_t>(room.uv.size());
        const float left = static_cast<float>(p) / kPlanes, right = (static_cast<float>(p) + 1.0f) / kPlanes;
        room.uv.insert(room.uv.end(), {{left + 0.02f, 0.1f}, {right - 0.02f, 0.1f}, {right - 0.02f, 0.9f}});
        room.corner_uv.push_back({first, first + 1, first + 2});
        room.face_page.push_back(0);
    }
    return room;
}

// The room with everything that a run leaves.
struct Example {
    TexturedMesh room = textured_room();
    TriangleMesh dense = box({4.0, 2.5, 3.0}, 40).mesh;
    Scan scan;
    Keyframes keyframes;
    Alignment alignment;
    LineMatches lines;
    Metrics metrics{{"texture.photograph", "", 0.9, Better::Higher}, {"views.model.psnr", "dB", 24.5, Better::Higher}};
    ReportParts parts;

    Example()
    {
        dense.color.assign(dense.position.size(), {200, 60, 60});
        for (auto& face : dense.face)
            std::swap(face[1], face[2]);
        parts.face_filled.assign(room.planes.mesh.face.size(), 0);
        parts.face_filled[0] = 1;
        scan.color = scan.depth = {640, 480, 525.0, 525.0, 319.5, 239.5};
        for (int i = 0; i < 5; ++i) {
            Frame frame;
            frame.camera_from_world.translation() = Vector3d(-1.0 - 0.2 * i, -1.2, -0.5);
            scan.frames.push_back(frame);
            keyframes.frame.push_back(static_cast<FrameId>(i));
            keyframes.reason.push_back(Dropped::Kept);
            keyframes.blur.push_back(0.2f + 0.01f * static_cast<float>(i));
            alignment.camera_from_world.push_back(frame.camera_from_world);
        }
        alignment.color = scan.color;
        alignment.energy_name = {"color", "line"};
        alignment.energy = {{3.0, 0.5}, {2.0, 0.25}, {1.5, 0.2}};
        alignment.held_out = {6.25, 7.5, true};
        LineMatch line;
        line.segment = {20.0f, 30.0f, 400.0f, 50.0f};
        line.planes = {0, 1};
        line.end_points = {Eigen::Vector3f(0.0f, 0.0f, 0.0f), Eigen::Vector3f(4.0f, 0.0f, 0.0f)};
        lines.push_back(line);
        parts.scan_name = "a room </script> & more";
        parts.pipeline = "indoor";
        parts.digest = "12ab";
        parts.textured = &room;
        parts.dense = &dense;
        parts.scan = &scan;
        parts.keyframes = &keyframes;
        parts.alignment = &alignment;
        parts.lines = &lines;
        parts.metrics = &metrics;
        parts.stages = {{"fuse", 2.5, 300000000, "{\"voxel_size\":0.01}"}};
    }
};

bool is_missing(const std::string& command) { return test::run_command("command -v " + command).exit_code != 0; }

// What Chromium saw of a page, or the reason why it could not be asked.
struct Opened {
    nlohmann::json seen;
    std::string skipped;
};

Opened open_page(const fs::path& page, const std::string& options = "")
{
    if (is_missing("node")) return {{}, "node is not installed"};
    if (!fs::exists(kNpm + "/node_modules/playwright-core")) return {{}, "run `npm ci` in tests/npm to check reports"};
    if (is_missing("chromium")) return {{}, "chromium is not installed"};
    const auto result = test::run_command("node '" + kNpm + "/open-report.cjs' '" + page.string() + "' " + options);
    if (result.exit_code != 0) throw std::runtime_error("open-report.cjs: " + result.output);
    return {nlohmann::json::parse(result.output, nullptr, false), ""};
}

TEST(Report, OpensInABrowserDrawsAndMeasures)
{
    const Example example;
    const TemporaryFolder folder;
    write_atomically(folder / "report.html", std::string_view(make_report(example.parts)));
    // Two points of the floor, 3.2 m apart along the room and 1 m across it.
    const auto [seen, skipped] =
        open_page(folder / "report.html", "--shots '" + folder.path().string() + "' --measure 0.4,0,1 3.6,0,2");
    if (!skipped.empty()) GTEST_SKIP() << skipped;
    EXPECT_THAT(seen["errors"], testing::IsEmpty()) << seen["errors"];
    EXPECT_THAT(seen["requests"], testing::IsEmpty()) << seen["requests"];
    EXPECT_GT(seen["first"]["drawn"], 0.2);
    EXPECT_EQ(seen["first"]["error"], 0);
    const double truth = std::hypot(3.2, 1.0), pixel = 0.01; // [m] a pixel of the overview covers no more
    EXPECT_NEAR(std::stod(seen["measured"]["text"].get<std::string>()), truth, pixel);
    EXPECT_NEAR(std::stod(seen["measured"]["label"].get<std::string>()), truth, pixel);
    EXPECT_GT(fs::file_size(folder / "first.png"), 10000u);
    EXPECT_LE(seen["overflow"], 0) << "nothing sticks out to the right";
    EXPECT_THAT(seen["sections"].get<std::vector<std::string>>(),
                testing::IsSupersetOf({"coverage", "metrics", "energies", "stages", "sharpness", "parameters"}));
}

TEST(Report, ShowsSomethingElseForEveryControl)
{
    const Example example;
    const TemporaryFolder folder;
    write_atomically(folder / "report.html", std::string_view(make_report(example.parts)));
    const auto [seen, skipped] = open_page(folder / "report.html", "--size 390x844 --dark");
    if (!skipped.empty()) GTEST_SKIP() << skipped;
    std::vector<std::int64_t> sums{seen["first"]["sum"]};
    for (const char* control : {"planes", "source", "plain", "wire", "lines", "cameras", "walls", "dense", "split"}) {
        ASSERT_TRUE(seen["controls"].contains(control)) << control;
        EXPECT_GT(seen["controls"][control]["drawn"], 0.1) << control;
        EXPECT_THAT(sums, Not(Contains(seen["controls"][control]["sum"].get<std::int64_t>()))) << control;
        sums.push_back(seen["controls"][control]["sum"]);
    }
    EXPECT_EQ(seen["controls"]["texture"]["sum"], seen["first"]["sum"]) << "back to where it was";
    EXPECT_LE(seen["overflow"], 0) << "nothing sticks out of a phone's screen";
    EXPECT_THAT(seen["errors"], testing::IsEmpty()) << seen["errors"];
}

TEST(Report, ShowsAModelWithoutTextureAndFigures)
{
    const PlaneMesh planes = room_corner(2);
    const TemporaryFolder folder;
    ReportParts parts;
    parts.scan_name = "corner";
    parts.planes = &planes;
    write_atomically(folder / "report.html", std::string_view(make_report(parts)));
    const auto [seen, skipped] = open_page(folder / "report.html");
    if (!skipped.empty()) GTEST_SKIP() << skipped;
    EXPECT_GT(seen["first"]["drawn"], 0.02);
    EXPECT_THAT(seen["errors"], testing::IsEmpty()) << seen["errors"];
}

TEST(Report, KeepsTextOfTheScanOutOfTheMarkup)
{
    const Example example;
    const std::string page = make_report(example.parts);
    EXPECT_THAT(page, AllOf(Not(HasSubstr("room </script>")), HasSubstr("a room &lt;/script&gt; &amp; more"),
                            HasSubstr("room \\u003c/script>"), Not(HasSubstr("{{"))));
    EXPECT_EQ(report_digest(page), "12ab");
    EXPECT_EQ(report_digest("<html>"), "");
}

TEST(Report, SaysThatTheAlignmentKeptItsInput)
{
    Example example;
    EXPECT_THAT(make_report(example.parts),
                HasSubstr(R"("held_out":{"input":6.25,"optimized":7.5,"is_input_kept":true})"));
    example.parts.draft_scores = HeldOutScores{12.5, 6.25, false};
    EXPECT_THAT(make_report(example.parts), HasSubstr(R"("held_out":{"input":12.5,"optimized":7.5,)"));
    example.alignment.held_out.reset();
    EXPECT_THAT(make_report(example.parts), Not(HasSubstr(R"("held_out":{)")));
}

TEST(Report, NamesNoOtherPlace)
{
    const std::string page = make_report(Example().parts);
    for (const char* reference : {"src=\"http", "href=\"http", "url(http", "import(", "fetch("})
        EXPECT_THAT(page, Not(HasSubstr(reference)));
}

TEST(Report, RefusesPartsOfDifferentRuns)
{
    Example example;
    example.alignment.camera_from_world.pop_back();
    EXPECT_THAT(test::error_of([&] { make_report(example.parts); }, ExitCode::Input), HasSubstr("one a keyframe"));
    EXPECT_THAT(test::error_of([] { make_report({}); }, ExitCode::Impossible), HasSubstr("no model"));
}

TEST(Base64, EncodesEveryLength)
{
    const auto encoded = [](const std::string& text) { return base64(std::as_bytes(std::span(text))); };
    EXPECT_EQ(encoded(""), "");
    EXPECT_EQ(encoded("f"), "Zg==");
    EXPECT_EQ(encoded("fo"), "Zm8=");
    EXPECT_EQ(encoded("foo"), "Zm9v");
    EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

TEST(Coarsen, KeepsTheShapeWithFewerFaces)
{
    TriangleMesh mesh = box({4.0, 2.5, 3.0}, 40).mesh;
    mesh.color.assign(mesh.position.size(), {10, 20, 30});
    const TriangleMesh coarse = coarsen(mesh, 4000);
    EXPECT_LE(coarse.face.size(), 4000u);
    EXPECT_GT(coarse.face.size(), 1000u);
    double area = 0.0;
    for (FaceId f = 0; f < coarse.face.size(); ++f)
        area += face_area(coarse, f);
    EXPECT_NEAR(area, 2.0 * (4.0 * 2.5 + 2.5 * 3.0 + 3.0 * 4.0), 5.0);
    EXPECT_EQ(coarse.color.front(), (Rgb8{10, 20, 30}));
    EXPECT_EQ(coarsen(mesh, 1000000).face, mesh.face);
}

} // namespace
} // namespace quoin
