// The borders of every plane as they are now, in the plane's own coordinates.
#pragma once

#include "simplify/thin_curves.h"
#include "simplify/triangulate.h"

#include <span>

namespace quoin {

struct PlaneOutline {
    struct Source { // of a segment: from slot to slot along the curve
        CurveId curve = 0;
        std::uint32_t from = 0, to = 0;
    };
    Outline outline;
    std::vector<VertexId> vertex; // one a point, ascending
    std::vector<Source> source;   // one a segment
};

class Outlines {
public:
    // skip: curves that bound nothing, one a curve; may grow.
    Outlines(const PlaneMesh& planes, const Curves& curves, const std::vector<std::uint8_t>& skip);
    std::span<const CurveId> curves_of(PlaneId p) const
    {
        return {curve_.data() + first_[p], first_[p + 1] - first_[p]};
    }
    PlaneOutline of(PlaneId p, const std::vector<Eigen::Vector3d>& position) const;

private:
    const PlaneMesh& planes_;
    const Curves& curves_;
    std::vector<std::uint32_t> first_; // P + 1
    const std::vector<std::uint8_t>& skip_;
    std::vector<CurveId> curve_; // by plane
};

// Coordinates in a plane, right-handed seen from where its normal points.
class PlaneFrame {
public:
    PlaneFrame(const Plane& plane, const Eigen::Vector3d& origin);
    Eigen::Vector2d operator()(const Eigen::Vector3d& p) const { return {u_.dot(p - origin_), v_.dot(p - origin_)}; }

private:
    Eigen::Vector3d origin_, u_, v_;
};

} // namespace quoin
