// Where the vertices of a curve may go: what both ways to simplify borders have in common.
#pragma once

#include "simplify/curves.h"
#include "simplify/quadric.h"
#include "simplify/simplify.h"

namespace quoin {

// A border vertex carries, weighted by the squared length l^2 of the dense edges around it, the quadrics of its planes,
// of the lines of those edges and of its own place; contracted vertices add up. Where two planes form a crease the
// minimum is moved onto the line in which they meet.
class CurveFit {
public:
    // position: where the vertices of the mesh are now [m].
    CurveFit(const PlaneMesh& planes, const Curves& curves, const std::vector<Eigen::Vector3d>& position,
             const SimplifyParams& params)
        : planes_(planes), curves_(curves), position_(position), params_(params)
    {
    }

    bool corner(std::uint32_t slot) const { return planes_.vertex_class[curves_.vertex[slot]] == VertexClass::Corner; }
    const Eigen::Vector3d& position(std::uint32_t slot) const { return position_[curves_.vertex[slot]]; }
    const Curve& curve(std::uint32_t slot) const { return curves_.curve[curves_.curve_of[slot]]; }

    // Adds those of a curve's dense edges to the slots that are left.
    void add_quadrics(const Curve& curve, std::vector<Quadric>& quadric) const;
    // Where s and t go when they become one, and what it costs to go to x.
    Eigen::Vector3d target(std::uint32_t s, std::uint32_t t, const std::vector<Quadric>& quadric) const;
    double cost(std::uint32_t s, std::uint32_t t, const Eigen::Vector3d& x, const std::vector<Quadric>& quadric) const;

    // Is every dense point between the neighbours of s and t near the polyline with x in their place? `tolerance`, one
    // a slot, scales the bounds; nullptr = 1.
    bool fits(std::uint32_t s, std::uint32_t t, const Eigen::Vector3d& x, const std::vector<float>* tolerance) const;

private:
    struct OneOrTwoPlanes {
        std::array<Plane, 2> plane;
        std::size_t count = 0;
        operator std::span<const Plane>() const { return {plane.data(), count}; }
    };
    OneOrTwoPlanes planes_of(const Curve& curve) const;
    bool within_error(const Eigen::Vector3d& offset, const Curve& curve, double tolerance) const;

    const PlaneMesh& planes_;
    const Curves& curves_;
    const std::vector<Eigen::Vector3d>& position_;
    const SimplifyParams& params_;
};

} // namespace quoin
