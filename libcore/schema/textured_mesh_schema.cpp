#include "mesh/textured_mesh.h"

#include "schema/mesh_tensors.h"
#include "schema/schema.h"

#include <cmath>

namespace quoin {
namespace {

std::string page_name(std::size_t page, const char* what) { return "page." + std::to_string(page) + "." + what; }

} // namespace

Artifact to_artifact(const TexturedMesh& mesh)
{
    Artifact artifact{"textured_mesh", 1, {}, {}};
    add_plane_mesh_tensors(artifact, mesh.planes);
    artifact.add<float>("uv", {mesh.uv.size(), 2}, mesh.uv);
    artifact.add<std::uint32_t>("corner_uv", {mesh.corner_uv.size(), 3}, mesh.corner_uv);
    artifact.add<std::uint32_t>("face_page", {mesh.face_page.size()}, mesh.face_page);
    std::vector<std::array<std::uint32_t, 2>> sizes;
    for (std::size_t i = 0; i < mesh.page.size(); ++i) {
        const AtlasPage& page = mesh.page[i];
        sizes.push_back({static_cast<std::uint32_t>(page.width), static_cast<std::uint32_t>(page.height)});
        artifact.add_bytes(page_name(i, "image"), DType::U8, {page.image.size()}, page.image);
        artifact.add_bytes(page_name(i, "texel_source"), DType::U8, {page.source.size()}, page.source);
    }
    artifact.add<std::uint32_t>("page.size", {sizes.size(), 2}, sizes);
    return artifact;
}

TexturedMesh read_textured_mesh(const std::filesystem::path& path)
{
    const Artifact artifact = read_artifact(path, "textured_mesh", 1);
    const TensorReader reader(artifact, path);
    TexturedMesh mesh;
    mesh.planes = read_plane_mesh_tensors(reader);
    const std::size_t faces = mesh.planes.mesh.face.size();
    mesh.uv = reader.array<float, Eigen::Vector2f>("uv", {kAny, 2});
    for (const auto& uv : mesh.uv)
        if (!uv.allFinite()) reader.refuse("uv", "holds a coordinate that is not finite");
    mesh.corner_uv = reader.array<std::uint32_t, std::array<std::uint32_t, 3>>("corner_uv", {faces, 3});
    if (faces > 0) reader.check_indices("corner_uv", mesh.corner_uv[0].data(), 3 * faces, mesh.uv.size());
    const auto sizes = reader.array<std::uint32_t, std::array<std::uint32_t, 2>>("page.size", {kAny, 2});
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        const auto image = reader.array<std::uint8_t, std::byte>(page_name(i, "image"), {kAny});
        const auto source = reader.array<std::uint8_t, std::byte>(page_name(i, "texel_source"), {kAny});
        mesh.page.push_back({static_cast<int>(sizes[i][0]), static_cast<int>(sizes[i][1]), image, source});
    }
    mesh.face_page = reader.array<std::uint32_t, std::uint32_t>("face_page", {faces});
    reader.check_indices("face_page", mesh.face_page.data(), faces, mesh.page.size());
    return mesh;
}

} // namespace quoin
