#pragma once

#include "synth/room.h"

namespace quoin {

// A stretch of the line in which two planes meet, where both have a border on it.
struct RoomCrease {
    std::array<Eigen::Vector3d, 2> ends;   // world [m]
    std::array<PlaneId, 2> planes{};       // the smaller first
    std::array<Eigen::Vector3d, 2> inward; // unit, from the edge into each plane
};

// All visible edges between planes of the room, convex and concave.
std::vector<RoomCrease> find_creases(const Room& room);

} // namespace quoin
