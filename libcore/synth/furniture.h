// Pieces of furniture. Object coordinates: the origin is on the floor in the middle of the back, y points into the
// room, z up [m].
#pragma once

#include "synth/random.h"
#include "synth/room.h"

#include <string>
#include <vector>

namespace quoin {

enum class Piece : std::uint8_t {
    Stairs,
    Bookshelf,
    Desk,
    Wardrobe,
    Sofa,
    Chimney,
    CrateStack,
    Bin,
    FloorLamp,
    Sideboard
};
inline constexpr int kPieces = 10;

// How a piece wants to stand.
struct Footprint {
    std::string name;
    double width, depth, height; // [m]
};
Footprint footprint(Piece piece, double room_height);

// Builds the piece into the room.
void build_piece(RoomBuilder& builder, Piece piece, const Footprint& footprint, const Rigid& world_from_object,
                 CounterRandom& random);

// A framed picture on a wall; object coordinates as furniture, its lower edge at height 0.
void build_picture(RoomBuilder& builder, const Rigid& world_from_object, const Eigen::Vector2d& size,
                   CounterRandom& random);
// A table in the middle of the room with things on it, and a ball under it; the origin is below its middle.
void build_low_table(RoomBuilder& builder, const Rigid& world_from_object, CounterRandom& random);

// A colour of paint, cloth or paper; `light` 0 dark .. 1 light.
Eigen::Vector3f any_tint(CounterRandom& random, double light);

} // namespace quoin
