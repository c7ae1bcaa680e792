#pragma once

#include <Eigen/Core>
#include <vector>

namespace quoin {

// A convex polygon in space, counter-clockwise about its normal [m].
using Polygon = std::vector<Eigen::Vector3d>;

double polygon_area(const Polygon& polygon);

// The part of `polygon` inside `hole`, and what is left of it as convex pieces. Both lie in one plane of normal
// `normal`, `polygon` counter-clockwise and `hole` either way. Without overlap `rest` is the polygon itself.
struct PolygonCut {
    Polygon common; // empty without overlap
    std::vector<Polygon> rest;
};
PolygonCut cut_polygon(const Polygon& polygon, const Polygon& hole, const Eigen::Vector3d& normal);

} // namespace quoin
