// Which triangles a cell of eight samples contributes (Lorensen and Cline 1987), by rule instead of by a hand-made
// table. On a face whose diagonal corners differ, the inside corners stay apart in both cells that share it: no holes.
// No triangle has an edge across a face of the cell other than the contour itself: no edge with four faces.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace quoin {

// Corner c of a cell is at (c & 1, c >> 1 & 1, c >> 2). Edge e runs along an axis from its lower corner.
struct CellEdge {
    std::uint8_t corner;
    std::uint8_t axis;
};
inline constexpr int kCellEdges = 12;
const std::array<CellEdge, kCellEdges>& cell_edges();

using CellTriangle = std::array<std::uint8_t, 3>; // edges of the cell; counter-clockwise seen from outside

// Triangles by the set of inside corners: bit c is corner c.
const std::array<std::vector<CellTriangle>, 256>& cell_triangles();

} // namespace quoin
