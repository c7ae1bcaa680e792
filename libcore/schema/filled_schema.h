// The optional tensor `face_filled` (F) u8 of plane_mesh and textured_mesh.
#pragma once

#include "artifact/artifact.h"
#include "mesh/filled.h"
#include "mesh/textured_mesh.h"

#include <filesystem>

namespace quoin {

Artifact to_artifact(const Filled<PlaneMesh>& mesh);
Artifact to_artifact(const Filled<TexturedMesh>& mesh);

// Empty when the artifact does not have it. Throws InputError when it is not one byte a face.
std::vector<std::uint8_t> read_face_filled(const std::filesystem::path& path);

} // namespace quoin
