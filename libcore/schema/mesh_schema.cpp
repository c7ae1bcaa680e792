#include "mesh/triangle_mesh.h"

#include "base/parallel.h"
#include "schema/mesh_tensors.h"
#include "schema/schema.h"

#include <fmt/format.h>
#include <utility>

namespace quoin {
namespace {

constexpr std::size_t kPositionGrain = 1 << 16; // [vertices]

} // namespace

void add_mesh_tensors(Artifact& artifact, TriangleMesh mesh)
{
    artifact.add<float>("position", {mesh.position.size(), 3}, std::move(mesh.position));
    artifact.add<std::uint32_t>("face", {mesh.face.size(), 3}, std::move(mesh.face));
    if (!mesh.color.empty()) artifact.add<std::uint8_t>("color", {mesh.color.size(), 3}, std::move(mesh.color));
    if (!mesh.normal.empty()) artifact.add<float>("normal", {mesh.normal.size(), 3}, std::move(mesh.normal));
}

TriangleMesh read_mesh_tensors(const TensorReader& reader)
{
    TriangleMesh mesh;
    parallel_tasks(
        [&] {
            mesh.face = reader.array<std::uint32_t, Face>("face", {kAny, 3});
        },
        [&] {
            mesh.position = reader.array<float, Eigen::Vector3f>("position", {kAny, 3});
        });
    const std::size_t count = mesh.position.size();
    const auto is_finite = [&](std::size_t v) { return mesh.position[v].allFinite(); };
    if (!parallel_all_of(count, kPositionGrain, is_finite))
        for (std::size_t v = 0; v < count; ++v)
            if (const auto& p = mesh.position[v]; !is_finite(v))
                reader.refuse("position",
                              fmt::format("vertex {} at ({}, {}, {}) is not finite", v, p.x(), p.y(), p.z()));
    if (!mesh.face.empty()) reader.check_indices("face", mesh.face[0].data(), 3 * mesh.face.size(), count);
    if (reader.has("color")) mesh.color = reader.array<std::uint8_t, Rgb8>("color", {count, 3});
    if (reader.has("normal")) mesh.normal = reader.array<float, Eigen::Vector3f>("normal", {count, 3});
    return mesh;
}

Artifact to_artifact(TriangleMesh mesh)
{
    Artifact artifact{"mesh", 1, {}, {}};
    add_mesh_tensors(artifact, std::move(mesh));
    return artifact;
}

TriangleMesh read_mesh(const std::filesystem::path& path)
{
    const Artifact artifact = read_artifact(path, "mesh", 1);
    return read_mesh_tensors(TensorReader(artifact, path));
}

} // namespace quoin
