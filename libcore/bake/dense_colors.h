// Colours of the dense mesh near a point.
#pragma once

#include "mesh/triangle_mesh.h"

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

namespace quoin {

// Looks up vertices by a grid of cells. Requires a mesh with vertex colours that outlives it.
class DenseColors {
public:
    // radius [m]: vertices farther away lend no colour.
    DenseColors(const TriangleMesh& dense, double radius);
    // Mean colour (0..255) of the nearest vertices that face the same side, weighted by inverse squared distance;
    // nullopt when there is none within the radius.
    std::optional<Eigen::Vector3f> at(const Eigen::Vector3d& p_world, const Eigen::Vector3d& normal_world) const;

private:
    struct Range {
        std::uint32_t begin = 0, end = 0; // into vertex_
    };
    std::optional<Eigen::Vector3f> within(int rings, const Eigen::Vector3f& p, const Eigen::Vector3f& normal) const;

    const TriangleMesh& dense_;
    float cell_;                          // [m]
    std::vector<Eigen::Vector3f> normal_; // V
    std::vector<VertexId> vertex_;        // by cell
    std::unordered_map<std::uint64_t, Range> cells_;
};

} // namespace quoin
