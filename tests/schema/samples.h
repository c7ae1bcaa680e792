// One small value of every schema.
#pragma once

#include "schema/schema.h"

namespace quoin::test {

Scan sample_scan();
TriangleMesh sample_mesh();
Keyframes sample_keyframes();
PlaneMesh sample_plane_mesh();
LineMatches sample_lines();
Alignment sample_alignment();
TexturedMesh sample_textured_mesh();
Metrics sample_metrics();

} // namespace quoin::test
