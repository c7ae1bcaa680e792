// How clean a mesh is as a combinatorial object: the counts that a report shows and tests compare.
#pragma once

#include "mesh/plane_mesh.h"

#include <cstddef>

namespace quoin {

struct HygieneLimits {
    double folded_cosine = -0.5; // faces on one edge whose normals' cosine is below are folded onto each other
    double sliver_ratio = 0.01;  // a face whose height is less than this fraction of its longest edge is a sliver
    double zero_height = 1e-7;   // [m] faces lower than this have no area; slivers are counted without them
};

// Edges are counted once, whatever the number of their faces. Counts without a remark should be zero.
struct Hygiene {
    std::size_t vertices = 0;           // any number
    std::size_t faces = 0;              // any number
    std::size_t non_manifold_edges = 0; // three or more faces
    std::size_t duplicate_faces = 0;    // faces beyond the first with the same three vertices
    std::size_t bow_tie_vertices = 0;   // whose faces fall into several fans over shared edges
    std::size_t folded_pairs = 0;       // thin sheets may be genuine
    std::size_t zero_area_faces = 0;
    std::size_t slivers = 0;
    std::size_t inconsistent_edges = 0; // two faces run along the edge the same way
    std::size_t isolated_vertices = 0;
    std::size_t components = 0;              // over shared edges; any number
    std::size_t border_edges = 0;            // any number
    double border_length = 0.0;              // [m]; any number
    std::ptrdiff_t euler_characteristic = 0; // V - E + F without isolated vertices; 2 for a closed box
    std::size_t flipped_faces = 0;           // that look away from their plane's normal
    std::size_t disconnected_planes = 0;     // planes whose faces are not connected over shared edges
    std::size_t empty_planes = 0;            // planes without faces
};

// A face that repeats a vertex counts as one without area.
Hygiene inspect(const TriangleMesh& mesh, const HygieneLimits& limits = {});
Hygiene inspect(const PlaneMesh& mesh, const HygieneLimits& limits = {});

} // namespace quoin
