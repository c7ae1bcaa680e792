// The nearest of many triangles or segments to a point (Embree's tree stays in the .cpp).
#pragma once

#include "mesh/triangle_mesh.h"

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace quoin {

struct NearestPoint {
    std::uint32_t item = 0; // face or segment; the smallest of several at the same distance
    Eigen::Vector3d point;
    double distance = 0.0; // [m]
};

using Segment3 = std::array<Eigen::Vector3d, 2>;

// Safe to ask from several threads.
class NearestItem {
public:
    explicit NearestItem(const TriangleMesh& mesh);
    explicit NearestItem(const std::vector<Segment3>& segments);
    // nullopt when nothing is within `reach` [m].
    std::optional<NearestPoint> find(const Eigen::Vector3d& point, double reach) const;

private:
    struct Tree;
    std::shared_ptr<const Tree> tree_;
};

Eigen::Vector3d nearest_on_triangle(const Eigen::Vector3d& point, const std::array<Eigen::Vector3d, 3>& corner);
Eigen::Vector3d nearest_on_segment(const Eigen::Vector3d& point, const Segment3& segment);

} // namespace quoin
