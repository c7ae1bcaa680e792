#include "schema/samples.h"

namespace quoin::test {
namespace {

Rigid quarter_turn()
{
    Rigid transform = Rigid::Identity();
    transform.linear() << 0, 1, 0, -1, 0, 0, 0, 0, 1;
    transform.translation() = Eigen::Vector3d(0.5, -1.25, 2.0);
    return transform;
}

Sha256 digest_of(std::uint8_t seed)
{
    Sha256 digest{};
    for (std::size_t i = 0; i < digest.size(); ++i)
        digest[i] = static_cast<std::uint8_t>(seed + i);
    return digest;
}

std::vector<std::byte> some_bytes(std::size_t count) { return std::vector<std::byte>(count, std::byte{7}); }

} // namespace

Scan sample_scan()
{
    Scan scan;
    scan.color = {640, 480, 518.5, 519.5, 320.25, 239.5, -0.03, 0.0};
    scan.depth = {320, 240, 292.5, 292.5, 160.0, 120.0, 0.0, 0.0};
    scan.depth_from_color.translation() = Eigen::Vector3d(-0.0275, 0.0165, -0.02);
    scan.max_depth = 6.0;
    scan.frames = {{Rigid::Identity(), FrameUse::Used, 0.0, {"a.jpg", digest_of(1)}, {"a.png", digest_of(2)}},
                   {quarter_turn(), FrameUse::HeldOut, 0.5, {"b c.jpg", digest_of(3)}, {"", {}}}};
    scan.dense_mesh = {"room.ply", digest_of(9)};
    return scan;
}

TriangleMesh sample_mesh()
{
    TriangleMesh mesh;
    mesh.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.face = {{0, 1, 2}, {0, 3, 1}};
    mesh.color = {Rgb8{1, 2, 3}, Rgb8{4, 5, 6}, Rgb8{7, 8, 9}, Rgb8{10, 11, 12}};
    return mesh;
}

Keyframes sample_keyframes()
{
    return {{0, 2}, {0.25f, 0.5f, 0.125f}, {Dropped::Kept, Dropped::Blurred, Dropped::Kept}};
}

PlaneMesh sample_plane_mesh()
{
    PlaneMesh planes;
    planes.mesh = sample_mesh();
    planes.face_plane = {0, 1};
    planes.plane = {{Eigen::Vector3d::UnitZ(), 0.0}, {Eigen::Vector3d::UnitY(), -0.5}};
    planes.moments = {triangle_moments({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                      triangle_moments({0, 0, 0}, {0, 0, 1}, {1, 0, 0})};
    planes.vertex_class = {VertexClass::Corner, VertexClass::Corner, VertexClass::Border, VertexClass::Border};
    return planes;
}

LineMatches sample_lines()
{
    return {{{1, 2, 30, 40}, 2, {0, 1}, {Eigen::Vector3f{0, 0, 0}, Eigen::Vector3f{1, 0, 0}}, 0.75f}};
}

Alignment sample_alignment()
{
    Alignment alignment;
    alignment.camera_from_world = {Rigid::Identity(), quarter_turn()};
    alignment.plane = sample_plane_mesh().plane;
    alignment.gain = {{1, 1, 1}, {1.125f, 1, 0.875f}};
    alignment.bias = {{0, 0, 0}, {2, 0, -2}};
    alignment.color = sample_scan().color;
    alignment.energy_name = {"color", "plane", "line"};
    alignment.energy = {{3.0, 2.0, 1.0}, {1.5, 1.0, 0.5}};
    return alignment;
}

TexturedMesh sample_textured_mesh()
{
    TexturedMesh textured;
    textured.planes = sample_plane_mesh();
    textured.uv = {{0, 0}, {0.5f, 0}, {0, 0.5f}, {0.5f, 0.5f}};
    textured.corner_uv = {{0, 1, 2}, {0, 3, 1}};
    textured.face_page = {0, 0};
    textured.page = {{4, 2, some_bytes(5), some_bytes(3)}};
    return textured;
}

Metrics sample_metrics()
{
    return {{"geometry.rms", "m", 0.004, Better::Lower}, {"size.faces", "", 1234, Better::Neither}};
}

} // namespace quoin::test
