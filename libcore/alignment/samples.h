// Points on the planes at which colours are compared: the texels.
#pragma once

#include "mesh/plane_mesh.h"

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace quoin {

using TexelId = std::uint32_t;

// Sorted by plane, and inside a plane by square tiles.
struct Texels {
    std::vector<Eigen::Vector3f> p_world;      // on the mesh [m]; moves only with its plane, by projection
    std::vector<PlaneId> plane;                // of every texel
    std::vector<std::array<int, 2>> cell;      // column and row in the grid of its plane
    std::vector<std::uint32_t> first_of_plane; // P + 1
    double spacing = 0.0;                      // [m]

    std::size_t size() const { return p_world.size(); }
};

// A square grid of `spacing` [m] on every plane, at the points that lie in a face of that plane (the smallest face id
// where faces overlap).
Texels sample_texels(const PlaneMesh& mesh, double spacing);

// The texels that `keep` marks, in the same order.
Texels kept(const Texels& texels, const std::vector<std::uint8_t>& keep);

} // namespace quoin
