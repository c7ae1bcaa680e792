// Repairs of a triangle mesh that any source may need. Each changes the mesh in place, keeps the order of what stays
// (but sort_along_morton) and returns how many items it removed or merged. Normals and colours follow their vertices.
#pragma once

#include "mesh/triangle_mesh.h"

#include <cstddef>

namespace quoin {

// Removes faces with a corner at a NaN or infinite position; returns the number of such positions. The vertices stay
// until remove_isolated_vertices().
std::size_t drop_non_finite(TriangleMesh& mesh);

// Merges every vertex into the first one within `tolerance` [m] (0: at the same position); returns the number merged.
// Their faces may become degenerate. Positions must be finite where faces use them.
std::size_t weld_vertices(TriangleMesh& mesh, double tolerance = 0.0);

// Removes faces that name a vertex twice or have no area.
std::size_t drop_degenerate_faces(TriangleMesh& mesh);

// Removes faces whose three vertices an earlier face has too, in any order.
std::size_t drop_duplicate_faces(TriangleMesh& mesh);

// Removes the components (over shared edges) that have fewer than `min_faces` faces or less than `min_area` [m^2].
struct RemovedComponents {
    std::size_t components = 0;
    std::size_t faces = 0;
};
RemovedComponents drop_small_components(TriangleMesh& mesh, std::size_t min_faces, double min_area);

// Gives each fan of faces around a vertex a vertex of its own where fans touch in that vertex only; returns the number
// of vertices added.
std::size_t split_touching_fans(TriangleMesh& mesh);

// Removes the vertices that no face uses.
std::size_t remove_isolated_vertices(TriangleMesh& mesh);

// Orders vertices along the Z-order curve through their bounding box, and faces by their smallest vertex: neighbours in
// space become neighbours in memory. Positions must be finite.
void sort_along_morton(TriangleMesh& mesh);

struct CleanupParams {
    double weld_tolerance = 0.0;
    int min_component_faces = 0;
    double min_component_area = 0.0;
};

struct CleanupReport {
    std::size_t non_finite_vertices = 0;
    std::size_t welded_vertices = 0;
    std::size_t degenerate_faces = 0;
    std::size_t duplicate_faces = 0;
    RemovedComponents small;
    std::size_t split_vertices = 0;
    std::size_t isolated_vertices = 0;
};

// All of the above, in this order.
CleanupReport clean_up(TriangleMesh& mesh, const CleanupParams& params = {});

} // namespace quoin
