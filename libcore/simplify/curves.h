// The network of borders: curves between two planes, or between a plane and nothing, from corner to corner or closed.
#pragma once

#include "mesh/plane_mesh.h"

#include <array>
#include <span>

namespace quoin {

// A curve is a run of consecutive slots, one a vertex of the mesh it was traced on. Corners have a slot in every curve
// that ends there. Slots that are left form a doubly linked list; `point` keeps where all of them were.
struct Curve {
    std::uint32_t first = 0, count = 0;                // slots
    std::uint32_t head = 0;                            // a slot that is left; that of the first corner if there is one
    std::array<PlaneId, 2> planes{kNoPlane, kNoPlane}; // the second is kNoPlane on a mesh border
    std::array<int, 2> runs{}; // of the planes' half-edges: 1 from slot to slot, -1 against; 0 both
    bool closed = false;
    bool in_mesh = true; // do faces of the mesh that is simplified lie at it?
};

struct Curves {
    static constexpr std::uint32_t kNone = 0xffffffffu;

    std::vector<Curve> curve;
    std::vector<std::uint32_t> curve_of;       // one per slot
    std::vector<VertexId> vertex;              // one per slot
    std::vector<Eigen::Vector3d> point;        // one per slot, world [m]
    std::vector<std::uint32_t> next, previous; // one per slot; kNone at the ends of an open curve

    std::size_t size() const { return vertex.size(); }
    bool left(std::uint32_t slot) const { return next[slot] != kNone || previous[slot] != kNone; }
    std::uint32_t edges(const Curve& c) const
    {
        return c.closed ? c.count : c.count - 1;
    } // of the mesh it was traced on
    std::uint32_t after(const Curve& c, std::uint32_t slot) const
    {
        return slot + 1 == c.first + c.count ? c.first : slot + 1;
    }
    // All slots of a curve are left again, its points where they are now.
    void restore(Curve& c);
};

// One half-edge of every edge between two planes or on the mesh border, ascending. Edges of three or more faces are
// none.
std::vector<std::uint32_t> border_half_edges(const PlaneMesh& mesh, const std::vector<std::uint32_t>& opposite);

// Curves in the order of their corners and the smallest vertex of closed ones. Edges of three or more faces are in no
// curve. border: of border_half_edges(), all or those of some planes.
Curves trace_curves(const PlaneMesh& mesh, const std::vector<std::uint32_t>& opposite,
                    std::span<const std::uint32_t> border);

} // namespace quoin
