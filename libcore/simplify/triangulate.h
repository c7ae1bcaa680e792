// Triangles between the borders of one plane.
#pragma once

#include "mesh/triangle_mesh.h"

#include <optional>
#include <utility>
#include <vector>

namespace quoin {

// Border segments in the coordinates of their plane; the inside is to the left. Ends are indices of points.
struct Outline {
    std::vector<Eigen::Vector2d> point;
    std::vector<std::array<std::uint32_t, 2>> segment;
};

// Pairs of segments that touch outside a common end; of two with a common end, those that lie on each other. Exact.
std::vector<std::array<std::uint32_t, 2>> crossings(const Outline& outline);

// Where segment i meets segment j, as a fraction of the way from its first end to its second; the middle if they are
// parallel.
double crossing_parameter(const Outline& outline, std::uint32_t i, std::uint32_t j);

// Where segments do not cross but contradict each other about which side is inside: those that fewer others around the
// same region agree with. A hole that the border around it was moved across is one.
std::vector<std::uint32_t> contradictions(const Outline& outline);

// Constrained Delaunay triangulation of the inside, counter-clockwise; nothing where the segments bound no inside: they
// cross, or do not agree about which side it is on.
std::optional<std::vector<Face>> triangulate(const Outline& outline);

} // namespace quoin
