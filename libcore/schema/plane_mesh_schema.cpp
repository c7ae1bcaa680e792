#include "base/parallel.h"
#include "schema/matrices.h"
#include "schema/mesh_tensors.h"
#include "schema/schema.h"

#include <utility>

namespace quoin {
namespace {

constexpr std::size_t kClassGrain = 1 << 16; // [vertices]

using Numbers10 = std::array<double, 10>; // area, first (3), second (6: xx xy xz yy yz zz)

Numbers10 numbers_of(const Moments& m)
{
    return {m.area,      m.first.x(), m.first.y(), m.first.z(), m.second[0],
            m.second[1], m.second[2], m.second[3], m.second[4], m.second[5]};
}

Moments moments_of(const Numbers10& n)
{
    Moments m;
    m.area = n[0];
    m.first = {n[1], n[2], n[3]};
    m.second << n[4], n[5], n[6], n[7], n[8], n[9];
    return m;
}

} // namespace

void add_plane_mesh_tensors(Artifact& artifact, PlaneMesh mesh)
{
    add_mesh_tensors(artifact, std::move(mesh.mesh));
    std::vector<Numbers10> moments;
    for (const auto& m : mesh.moments)
        moments.push_back(numbers_of(m));
    artifact.add<std::uint32_t>("face_plane", {mesh.face_plane.size()}, std::move(mesh.face_plane));
    add_planes(artifact, "plane", mesh.plane);
    artifact.add<double>("moments", {moments.size(), 10}, std::move(moments));
    artifact.add<std::uint8_t>("vertex_class", {mesh.vertex_class.size()}, std::move(mesh.vertex_class));
}

PlaneMesh read_plane_mesh_tensors(const TensorReader& reader)
{
    PlaneMesh mesh;
    parallel_tasks([&] { mesh.mesh = read_mesh_tensors(reader); },
                   [&] {
                       mesh.face_plane = reader.array<std::uint32_t, PlaneId>("face_plane", {kAny});
                       mesh.vertex_class = reader.array<std::uint8_t, VertexClass>("vertex_class", {kAny});
                   });
    reader.check_length("face_plane", mesh.face_plane.size(), "face", mesh.mesh.face.size());
    reader.check_length("vertex_class", mesh.vertex_class.size(), "position", mesh.mesh.position.size());
    mesh.plane = read_planes(reader, "plane");
    reader.check_indices("face_plane", mesh.face_plane.data(), mesh.face_plane.size(), mesh.plane.size());
    for (const auto& row : reader.array<double, Numbers10>("moments", {mesh.plane.size(), 10})) {
        reader.check_finite("moments", row.data(), row.size());
        mesh.moments.push_back(moments_of(row));
    }
    const auto is_class = [&](std::size_t v) { return mesh.vertex_class[v] <= VertexClass::Corner; };
    if (!parallel_all_of(mesh.vertex_class.size(), kClassGrain, is_class))
        reader.refuse("vertex_class", "holds a class above 2");
    return mesh;
}

Artifact to_artifact(PlaneMesh mesh)
{
    Artifact artifact{"plane_mesh", 1, {}, {}};
    add_plane_mesh_tensors(artifact, std::move(mesh));
    return artifact;
}

PlaneMesh read_plane_mesh(const std::filesystem::path& path)
{
    const Artifact artifact = read_artifact(path, "plane_mesh", 1);
    return read_plane_mesh_tensors(TensorReader(artifact, path));
}

} // namespace quoin
