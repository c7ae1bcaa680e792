#include "schema/filled_schema.h"

#include "schema/schema.h"
#include "schema/tensor_io.h"

namespace quoin {
namespace {

constexpr const char* kName = "face_filled";

template <class Mesh>
Artifact with_marks(const Filled<Mesh>& mesh)
{
    Artifact artifact = to_artifact(mesh.mesh);
    if (!mesh.face_filled.empty()) artifact.add<std::uint8_t>(kName, {mesh.face_filled.size()}, mesh.face_filled);
    return artifact;
}

} // namespace

Artifact to_artifact(const Filled<PlaneMesh>& mesh) { return with_marks(mesh); }

Artifact to_artifact(const Filled<TexturedMesh>& mesh) { return with_marks(mesh); }

std::vector<std::uint8_t> read_face_filled(const std::filesystem::path& path)
{
    const Artifact artifact = read_artifact(path);
    const TensorReader reader(artifact, path);
    if (!reader.has(kName)) return {};
    const std::size_t faces = reader.array<std::uint32_t, Face>("face", {kAny, 3}).size();
    return reader.array<std::uint8_t, std::uint8_t>(kName, {faces});
}

} // namespace quoin
