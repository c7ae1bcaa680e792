#pragma once

#include "mesh/triangle_mesh.h"
#include "simplify/outlines.h"

#include <algorithm>
#include <vector>

namespace quoin {

// What lies within reach [m] of points of a plane, along it; at least one point.
class Surroundings {
public:
    Surroundings(const Plane& plane, const std::vector<Eigen::Vector3d>& points, double reach)
        : frame_(plane, points.front()), reach_(reach)
    {
        for (const Eigen::Vector3d& p : points)
            point_.push_back(frame_(p));
        std::sort(point_.begin(), point_.end(), left_of);
    }

    // Does a vertex of the face?
    bool has(const TriangleMesh& mesh, FaceId f) const
    {
        return near(corner(mesh, f, 0)) || near(corner(mesh, f, 1)) || near(corner(mesh, f, 2));
    }

private:
    static bool left_of(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() < b.x(); }
    bool near(const Eigen::Vector3d& position) const
    {
        const Eigen::Vector2d p = frame_(position);
        const Eigen::Vector2d left(p.x() - reach_, p.y());
        auto at = std::lower_bound(point_.begin(), point_.end(), left, left_of);
        for (; at != point_.end() && at->x() <= p.x() + reach_; ++at)
            if ((*at - p).squaredNorm() <= reach_ * reach_) return true;
        return false;
    }

    PlaneFrame frame_;
    double reach_;                       // [m]
    std::vector<Eigen::Vector2d> point_; // ascending in x
};

} // namespace quoin
