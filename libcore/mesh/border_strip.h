// The faces along the borders of planes and mesh: a tenth of a dense mesh, and all that a change of planes can touch.
#pragma once

#include "mesh/plane_mesh.h"

namespace quoin {

struct BorderStrip {
    TriangleMesh mesh;            // positions and faces
    std::vector<FaceId> face;     // of the whole mesh, ascending
    std::vector<VertexId> vertex; // of the whole mesh
    std::vector<PlaneId> face_plane;
    // As opposite_half_edges has it; half-edges that are on no border of planes or mesh are their own opposites.
    std::vector<std::uint32_t> opposite;
};

// The faces with a vertex that is not VertexClass::Inner.
BorderStrip border_strip(const PlaneMesh& mesh);

} // namespace quoin
