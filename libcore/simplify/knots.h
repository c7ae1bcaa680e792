// Where the border of a plane that could not be filled goes wrong.
#pragma once

#include "simplify/outlines.h"

namespace quoin {

// The segments around all pieces of a filling but the largest. What is filled is one piece of a surface; but a part
// that sticks out of it on a stalk, with a border of its own, is laid down beside it.
std::vector<std::uint32_t> segments_aside(const Outline& outline, const std::vector<Face>& faces);

// The segments along and opposite faces of a filling without area: borders that were moved onto one line leave no room.
std::vector<std::uint32_t> segments_without_room(const PlaneOutline& plane,
                                                 const std::vector<Eigen::Vector3d>& position,
                                                 const std::vector<Face>& faces);

// Where borders cross; or ends and middles of the segments that are spoilt in other ways or else contradict each other
// [m].
std::vector<Eigen::Vector3d> find_knots(const PlaneOutline& plane, const std::vector<Eigen::Vector3d>& position,
                                        const std::vector<std::uint32_t>& spoilt);

} // namespace quoin
