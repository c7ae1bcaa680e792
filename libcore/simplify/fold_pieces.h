// The faces around a fold, as they are or as they would be, and how bad they are.
#pragma once

#include "mesh/plane_mesh.h"
#include "simplify/zero_area.h"

#include <limits>
#include <vector>

namespace quoin {

// A face of a neighbourhood.
struct Piece {
    Piece(const Face& face, const Triangle& corners, PlaneId plane_id);

    Face vertex;
    Triangle corner;
    PlaneId plane;
    Eigen::Vector3d normal; // unit; zero without area
    bool flat;              // has it no area?
};
using Pieces = std::vector<Piece>;

// Two lists as one.
struct TwoPieces {
    const Pieces& inner;
    const Pieces& outer;
};

// Faces without area or that look away, and folded edges, of the inner pieces, weighted; more than `enough` is only a
// lower bound.
int defects(const TwoPieces& pieces, const std::vector<Plane>& planes, int enough = std::numeric_limits<int>::max());

// Corners and middles of `from` are that far from `to` at most [m]; more than `enough` is only a lower bound.
double farthest(const Pieces& from, const TwoPieces& to, double enough);

double area_of(const Pieces& pieces); // [m^2]

// Do the faces have two vertices in common?
inline bool shares_edge(const Face& a, const Face& b)
{
    int shared = 0;
    for (const VertexId v : a)
        shared += int(v == b[0]) + int(v == b[1]) + int(v == b[2]);
    return shared == 2;
}

} // namespace quoin
