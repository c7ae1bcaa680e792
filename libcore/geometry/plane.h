#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace quoin {

using PlaneId = std::uint32_t;
inline constexpr PlaneId kNoPlane = 0xffffffffu;

// The plane normal . x + offset = 0, with a unit normal.
struct Plane {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    double offset = 0.0; // [m]

    double signed_distance(const Eigen::Vector3d& point) const { return normal.dot(point) + offset; }
    Eigen::Vector3d project(const Eigen::Vector3d& point) const { return point - signed_distance(point) * normal; }
    Plane flipped() const { return {-normal, -offset}; }
};

} // namespace quoin
