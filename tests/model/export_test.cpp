#include "build_paths.h"
#include "model/export_model.h"

#include "base/atomic_file.h"
#include "image/image_io.h"
#include "mesh/ply.h"
#include "model/leveling.h"
#include "support/command.h"
#include "support/expect_error.h"
#include "support/plane_meshes.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cstring>
#include <map>
#include <numbers>
#include <sstream>

namespace quoin {
namespace {
namespace fs = std::filesystem;
using namespace testing_support;
using Eigen::Vector3d;
using test::TemporaryFolder;

// Every face on a page of its own colour, two pages.
TexturedMesh textured_corner(bool jpeg)
{
    TexturedMesh textured;
    textured.planes = room_corner(2);
    const auto& mesh = textured.planes.mesh;
    for (FaceId f = 0; f < mesh.face.size(); ++f) {
        textured.face_page.push_back(textured.planes.face_plane[f] == 0 ? 0 : 1);
        std::array<std::uint32_t, 3> corners{};
        for (std::size_t k = 0; k < 3; ++k) {
            corners[k] = static_cast<std::uint32_t>(textured.uv.size());
            const auto& p = mesh.position[mesh.face[f][k]];
            textured.uv.push_back(Eigen::Vector2f(p.x() + p.z(), p.y() + p.z()) * 0.5f);
        }
        textured.corner_uv.push_back(corners);
    }
    for (const Rgb8 color : {Rgb8{200, 100, 50}, Rgb8{50, 100, 200}}) {
        const ColorImage image(32, 16, color);
        textured.page.push_back(
            {32, 16, jpeg ? encode_jpeg(image, 92) : encode_png(image), encode_png(Image<std::uint8_t>(32, 16, 1))});
    }
    return textured;
}

struct Glb {
    nlohmann::json json;
    std::string binary;

    template <class T>
    std::vector<T> values(std::size_t accessor) const
    {
        const auto& view = json["bufferViews"][json["accessors"][accessor]["bufferView"].get<std::size_t>()];
        std::vector<T> result(view["byteLength"].get<std::size_t>() / sizeof(T));
        std::memcpy(static_cast<void*>(result.data()), binary.data() + view["byteOffset"].get<std::size_t>(),
                    result.size() * sizeof(T));
        return result;
    }
};

std::uint32_t word(const std::string& bytes, std::size_t offset)
{
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

Glb read_glb(const fs::path& path)
{
    const std::string bytes = read_text(path);
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(word(bytes, 8), bytes.size());
    const std::size_t json_length = word(bytes, 12);
    return {nlohmann::json::parse(bytes.substr(20, json_length)), bytes.substr(28 + json_length)};
}

// A scan whose cameras stand upright in a world whose up direction is `up`.
Scan scan_with_up(const Vector3d& up)
{
    Scan scan;
    for (int i = 0; i < 4; ++i) {
        Frame frame;
        const Vector3d right = up.unitOrthogonal(), forward = Eigen::AngleAxisd(1.5 * i, up) * right;
        Rigid world_from_camera = Rigid::Identity();
        world_from_camera.linear() << forward.cross(up) * -1.0, up * -1.0, forward;
        world_from_camera.linear().col(0) = world_from_camera.linear().col(1).cross(world_from_camera.linear().col(2));
        world_from_camera.translation() = up * 1.5;
        frame.camera_from_world = world_from_camera.inverse();
        frame.time = 10.0 + i;
        scan.frames.push_back(frame);
    }
    return scan;
}

fs::path exported(const TemporaryFolder& folder, const ModelParts& parts, const ExportParams& params = {})
{
    export_model(parts, folder.path(), params);
    return folder.path();
}

TEST(Export, WritesAGlbThatReadsBack)
{
    const TexturedMesh textured = textured_corner(true);
    const TemporaryFolder folder;
    const Glb glb = read_glb(exported(folder, {.textured = &textured}) / "model.glb");
    const auto& primitives = glb.json["meshes"][0]["primitives"];
    ASSERT_EQ(primitives.size(), 2u) << "one a page";
    std::size_t faces = 0;
    double area = 0.0;
    for (const auto& primitive : primitives) {
        const auto indices = glb.values<std::uint16_t>(primitive["indices"]);
        const auto positions = glb.values<Eigen::Vector3f>(primitive["attributes"]["POSITION"]);
        const auto normals = glb.values<Eigen::Vector3f>(primitive["attributes"]["NORMAL"]);
        EXPECT_EQ(glb.values<Eigen::Vector2f>(primitive["attributes"]["TEXCOORD_0"]).size(), positions.size());
        const std::size_t count = glb.json["accessors"][primitive["indices"].get<std::size_t>()]["count"];
        faces += count / 3;
        for (std::size_t i = 0; i < count; i += 3) {
            const Eigen::Vector3f a = positions[indices[i]], b = positions[indices[i + 1]],
                                  c = positions[indices[i + 2]];
            const Eigen::Vector3f n = (b - a).cross(c - a);
            area += 0.5 * n.norm();
            EXPECT_NEAR(n.normalized().dot(normals[indices[i]]), 1.0f, 1e-6f) << "counter-clockwise towards the room";
        }
    }
    EXPECT_EQ(faces, textured.planes.mesh.face.size());
    EXPECT_NEAR(area, 3.0, 1e-5);
    EXPECT_EQ(glb.json["images"][0]["mimeType"], "image/jpeg");
    for (const auto& view : glb.json["bufferViews"])
        EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0u);
}

TEST(Export, WritesAnObjThatReadsBack)
{
    const TexturedMesh textured = textured_corner(false);
    const TemporaryFolder folder;
    const fs::path model = exported(folder, {.textured = &textured});
    std::istringstream lines(read_text(model / "model.obj"));
    std::map<std::string, std::size_t> count;
    for (std::string line; std::getline(lines, line);)
        ++count[line.substr(0, line.find(' '))];
    EXPECT_EQ(count["f"], textured.planes.mesh.face.size());
    EXPECT_EQ(count["v"], count["vt"]);
    EXPECT_EQ(count["v"], count["vn"]);
    EXPECT_EQ(count["usemtl"], 2u);
    EXPECT_EQ(count["g"], 3u);
    EXPECT_THAT(read_text(model / "model.mtl"), testing::HasSubstr("map_Kd model_1.png\n"));
    EXPECT_TRUE(fs::exists(model / "model_1.png"));
}

TEST(Export, WritesAPlyWithThePlanesOfFaces)
{
    const PlaneMesh planes = room_corner(2);
    const TemporaryFolder folder;
    const fs::path model = exported(folder, {.planes = &planes});
    const TriangleMesh mesh = read_ply(model / "model.ply");
    EXPECT_EQ(mesh.face, planes.mesh.face);
    EXPECT_EQ(mesh.position.size(), planes.mesh.position.size());
    EXPECT_THAT(read_text(model / "model.ply"), testing::HasSubstr("property int plane"));
}

TEST(Export, PutsTheFloorLevelAtHeightZeroWithWallsAlongTheAxes)
{
    // A corner whose floor normal is z, turned somehow; the cameras' up is 5 degrees off.
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.0, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    PlaneMesh planes = room_corner(2);
    for (auto& p : planes.mesh.position)
        p = (turn * p.cast<double>() + Vector3d(1, 2, 3)).cast<float>();
    for (auto& plane : planes.plane) {
        plane.normal = turn * plane.normal;
        plane.offset -= plane.normal.dot(Vector3d(1, 2, 3));
    }
    const Vector3d up =
        turn * (Eigen::AngleAxisd(5.0 * std::numbers::pi / 180.0, Vector3d::UnitX()) * Vector3d::UnitZ());
    const Scan scan = scan_with_up(up);
    const TemporaryFolder folder;
    const fs::path model = exported(folder, {.planes = &planes, .scan = &scan});

    const auto json = nlohmann::json::parse(read_text(model / "planes.json"));
    const auto normal = [&](int p) {
        return json["planes"][static_cast<std::size_t>(p)]["normal"].get<std::vector<double>>();
    };
    EXPECT_NEAR(normal(0)[1], 1.0, 1e-6) << "the floor is level though the cameras are not";
    EXPECT_NEAR(json["planes"][0]["offset"].get<double>(), 0.0, 1e-6) << "and at height 0";
    EXPECT_TRUE(json["planes"][0]["floor"].get<bool>());
    for (const int wall : {1, 2})
        EXPECT_NEAR(std::max(std::abs(normal(wall)[0]), std::abs(normal(wall)[2])), 1.0, 1e-6);
    const auto summary = nlohmann::json::parse(read_text(model / "summary.json"));
    EXPECT_TRUE(summary["frame"]["levelled"].get<bool>());
    EXPECT_NEAR(summary["bounds"]["min"][1].get<double>(), 0.0, 1e-5);
    EXPECT_NEAR(summary["bounds"]["max"][1].get<double>(), 1.0, 1e-5);
}

TEST(Export, TakesTheLowestLargePlaneForTheFloor)
{
    const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY();
    const PlaneMesh planes = join_sheets({{{0, 0, 0.8}, 2 * x, 2 * y, 1},  // a table, larger than
                                          {{2, 0, 0}, x, y, 1},            // what is seen of the floor,
                                          {{5, 0, -0.5}, 0.1 * x, y, 1}}); // and a reflection below it
    std::vector<Rigid> poses;
    for (const auto& frame : scan_with_up(Vector3d::UnitZ()).frames)
        poses.push_back(frame.camera_from_world);
    EXPECT_EQ(find_level(planes.mesh, &planes, poses, {}).floor, PlaneId{1});
}

TEST(Export, WritesTheTrajectoryInTheModelFrame)
{
    const PlaneMesh planes = room_corner(2);
    const Scan scan = scan_with_up(Vector3d::UnitZ());
    const TemporaryFolder folder;
    std::istringstream lines(read_text(exported(folder, {.planes = &planes, .scan = &scan}) / "trajectory.txt"));
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line[0], '#');
    for (std::size_t i = 0; std::getline(lines, line); ++i) {
        std::istringstream numbers(line);
        double time = 0.0, x = 0.0, y = 0.0, z = 0.0;
        Eigen::Quaterniond q;
        numbers >> time >> x >> y >> z >> q.x() >> q.y() >> q.z() >> q.w();
        EXPECT_EQ(time, scan.frames[i].time);
        EXPECT_NEAR(y, 1.5, 1e-6) << "cameras stand 1.5 m over the floor";
        EXPECT_NEAR((q * -Vector3d::UnitY() - Vector3d::UnitY()).norm(), 0.0, 1e-6) << "and upright";
    }
}

TEST(Export, KeepsTheWorldFrameWithoutCameras)
{
    const PlaneMesh planes = room_corner(1);
    const TemporaryFolder folder;
    const auto summary = nlohmann::json::parse(read_text(exported(folder, {.planes = &planes}) / "summary.json"));
    EXPECT_FALSE(summary["frame"]["levelled"].get<bool>());
    EXPECT_EQ(summary["frame"]["model_from_world"][0][0].get<double>(), 1.0);
    EXPECT_GT(summary["files"]["model.glb"].get<int>(), 0);
}

TEST(Export, RefusesAMeshWithoutFaces)
{
    const TriangleMesh nothing;
    const TemporaryFolder folder;
    EXPECT_THAT(test::error_of([&] { exported(folder, {.mesh = &nothing}); }, ExitCode::Impossible),
                testing::HasSubstr("no faces"));
    EXPECT_THAT(test::error_of([&] { exported(folder, {}); }, ExitCode::Usage),
                testing::HasSubstr("nothing to export"));
}

class GltfValidator : public testing::Test {
protected:
    void SetUp() override
    {
        if (test::run_command("node --version").exit_code != 0) GTEST_SKIP() << "node is not installed";
        if (!fs::exists(kNpm + "/node_modules/gltf-validator"))
            GTEST_SKIP() << "gltf-validator is not installed; run npm ci in tests/npm";
    }
    static void expect_valid(const ModelParts& parts)
    {
        const TemporaryFolder folder;
        const auto result = test::run_command("node '" + kNpm + "/validate-glb.cjs' '" +
                                              (exported(folder, parts) / "model.glb").string() + "'");
        EXPECT_EQ(result.exit_code, 0) << result.output;
    }
    inline static const std::string kNpm = QUOIN_SOURCE_DIR "/tests/npm";
};

TEST_F(GltfValidator, AcceptsATexturedModel)
{
    const TexturedMesh jpeg = textured_corner(true), png = textured_corner(false);
    const Scan scan = scan_with_up(Vector3d::UnitZ());
    expect_valid({.textured = &jpeg, .scan = &scan, .version = "1.2.3"});
    expect_valid({.textured = &png});
}

TEST_F(GltfValidator, AcceptsModelsWithoutTexture)
{
    PlaneMesh planes = room_corner(3);
    expect_valid({.planes = &planes});
    expect_valid({.mesh = &planes.mesh});
    planes.mesh.color.assign(planes.mesh.position.size(), Rgb8{10, 200, 90});
    expect_valid({.mesh = &planes.mesh});
}

TEST_F(GltfValidator, AcceptsFacesWithoutArea)
{
    PlaneMesh planes = room_corner(1);
    const auto far = static_cast<VertexId>(planes.mesh.position.size());
    planes.mesh.position.insert(planes.mesh.position.end(), 3, Eigen::Vector3f(3, 3, 3));
    planes.mesh.face.push_back({far, far + 1, far + 2});
    planes.mesh.face.push_back({0, 1, 1});
    planes.face_plane.insert(planes.face_plane.end(), 2, PlaneId{1});
    expect_valid({.planes = &planes});
}

TEST_F(GltfValidator, AcceptsMoreVerticesThan16BitIndicesReach)
{
    const PlaneMesh planes = room_corner(160);
    expect_valid({.planes = &planes});
}

} // namespace
} // namespace quoin
