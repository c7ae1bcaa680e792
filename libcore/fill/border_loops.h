#pragma once

#include "mesh/plane_mesh.h"

#include <vector>

namespace quoin {

// A closed border of the mesh without repeated vertices, in the order in which a face that closes it runs: the mesh is
// on the right. Edge i runs from vertex[i] to the next one.
struct BorderLoop {
    std::vector<VertexId> vertex;
    std::vector<PlaneId> plane; // of the face on each edge
    std::vector<FaceId> face;   // on each edge
};

// In order of their first border edge. Where a border meets itself in a vertex, it is cut into loops there; borders
// that run into an edge of three or more faces are left out.
std::vector<BorderLoop> border_loops(const PlaneMesh& mesh);

} // namespace quoin
