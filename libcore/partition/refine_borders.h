// Border refinement: faces on the border between two clusters change sides where that lowers the energy.
#pragma once

#include "mesh/triangle_mesh.h"

#include <cstdint>
#include <vector>

namespace quoin {

struct RefineLimits {
    double rounds = 0.0;          // moves tried at most: this many times the border faces at the start
    double border_distance = 0.0; // [m], see border_weight
    double max_error = 0.0;       // a move that raises a cluster's RMS distance beyond is refused [m]
    double min_facing = 0.0;
    double min_part_cosine = -1.0; // a face moves to no cluster that faces away from it by more
    double flat_variance = 0.0;    // [m^2]
};

// Lowers  sum of E(C) + border_weight * length of all borders  by single moves, one after the other, each with the sums
// of the moment; so it never rises. Faces whose neighbourhood changed are tried again. Every cluster stays connected
// and none is emptied. opposite: opposite_half_edges(mesh); label: cluster of each face, 0 .. n-1.
void refine_borders(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite, const RefineLimits& limits,
                    std::vector<std::uint32_t>& label);

// Cost of a metre of border [m^3]: moving a mean face from its plane to one that is border_distance off pays if it
// shortens the border by a mean edge. The energy of a face at distance d is area d^2 / 144.
double border_weight(const TriangleMesh& mesh, double border_distance);

} // namespace quoin
