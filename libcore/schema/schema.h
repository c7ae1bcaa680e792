// Reading and writing every artifact of the data path: one schema, one type, one pair. A reader checks all lengths,
// types, shapes and index ranges and throws InputError naming file, tensor and value; a writer publishes atomically.
#pragma once

#include "artifact/artifact.h"
#include "base/metrics.h"
#include "mesh/line_matches.h"
#include "mesh/textured_mesh.h"
#include "scan/alignment.h"
#include "scan/keyframes.h"

#include <filesystem>

namespace quoin {

Scan read_scan(const std::filesystem::path& path);
TriangleMesh read_mesh(const std::filesystem::path& path);
Keyframes read_keyframes(const std::filesystem::path& path);
PlaneMesh read_plane_mesh(const std::filesystem::path& path);
LineMatches read_lines(const std::filesystem::path& path);
Alignment read_alignment(const std::filesystem::path& path);
TexturedMesh read_textured_mesh(const std::filesystem::path& path);
Metrics read_metrics(const std::filesystem::path& path);

// The artifact without its provenance; the stage runner adds that and publishes it (stage/stage.h, Outputs::write).
Artifact to_artifact(const Scan& scan);
Artifact to_artifact(TriangleMesh mesh);
Artifact to_artifact(const Keyframes& keyframes);
Artifact to_artifact(PlaneMesh mesh);
Artifact to_artifact(const LineMatches& lines);
Artifact to_artifact(const Alignment& alignment);
Artifact to_artifact(const TexturedMesh& mesh);
Artifact to_artifact(const Metrics& metrics);

} // namespace quoin
