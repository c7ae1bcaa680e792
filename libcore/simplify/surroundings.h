#pragma once

#include "mesh/triangle_mesh.h"
#include "simplify/outlines.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace quoin {

// What lies within reach [m] of points of a plane, along it; at least one point.
class Surroundings {
public:
    Surroundings(const Plane& plane, const std::vector<Eigen::Vector3d>& points, double reach)
        : frame_(plane, points.front()), reach_(reach)
    {
        for (std::uint32_t i = 0; i < points.size(); ++i)
            point_.push_back({frame_(points[i]), i});
        std::ranges::sort(point_, {}, [](const Point& p) { return std::pair(p.at.x(), p.index); });
    }

    // Does a vertex of the face?
    bool has(const TriangleMesh& mesh, FaceId f) const
    {
        return near(corner(mesh, f, 0)) || near(corner(mesh, f, 1)) || near(corner(mesh, f, 2));
    }

    // Calls visit(i) for every point i that `position` lies within reach of.
    template <class Visit>
    void for_each(const Eigen::Vector3d& position, const Visit& visit) const
    {
        visit_until(position, [&](std::uint32_t i) { return visit(i), false; });
    }

private:
    struct Point {
        Eigen::Vector2d at;
        std::uint32_t index = 0; // as it was given
    };

    bool near(const Eigen::Vector3d& position) const
    {
        return visit_until(position, [](std::uint32_t) { return true; });
    }

    template <class Visit>
    bool visit_until(const Eigen::Vector3d& position, const Visit& visit) const
    {
        const Eigen::Vector2d p = frame_(position);
        auto at = std::ranges::lower_bound(point_, p.x() - reach_, {}, [](const Point& q) { return q.at.x(); });
        for (; at != point_.end() && at->at.x() <= p.x() + reach_; ++at)
            if ((at->at - p).squaredNorm() <= reach_ * reach_ && visit(at->index)) return true;
        return false;
    }

    PlaneFrame frame_;
    double reach_;             // [m]
    std::vector<Point> point_; // ascending in x
};

} // namespace quoin
