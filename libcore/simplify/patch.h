// The faces of one plane as a mesh of its own, so that planes can be simplified in parallel.
#pragma once

#include "geometry/groups.h"
#include "simplify/chords.h"
#include "simplify/collapse_mesh.h"

namespace quoin {

// Local vertices: inner ones first, then those on borders, each in the order of their global ids.
struct Patch {
    PlaneId id = 0;
    Plane plane;            // about `origin`
    Eigen::Vector3d origin; // world [m]; local positions are relative to it
    VertexId inner_count = 0;
    std::vector<VertexId> global; // local vertex -> vertex of the plane mesh
    CollapseMesh mesh;
    const Chords* chords = nullptr;

    bool inner(VertexId v) const { return v < inner_count; }
    bool may_join(VertexId a, VertexId b) const
    {
        return inner(a) || inner(b) || chords->may_join(id, global[a], global[b]);
    }
    bool inside(VertexId a, VertexId b) const
    {
        return inner(a) || inner(b) || chords->inside(id, global[a], global[b]);
    }
    bool may_fill(VertexId a, VertexId b, VertexId c) const
    {
        return inner(a) || inner(b) || inner(c) || chords->may_fill(id, {global[a], global[b], global[c]});
    }
};

// Faces of every plane and the rank of every inner vertex among those of its plane.
class PatchIndex {
public:
    explicit PatchIndex(const PlaneMesh& mesh);
    std::size_t size(PlaneId p) const { return faces_.of(p).size(); }
    Patch extract(PlaneId p) const;

private:
    const PlaneMesh& mesh_;
    Chords chords_;
    Groups faces_, inner_;            // by plane: faces, inner vertices
    std::vector<std::uint32_t> rank_; // V
};

// Flips edges inside the plane whose opposite angles add up to more than pi, until none is left or `sweeps` are done.
// Returns the number of flips.
std::size_t flip_to_delaunay(Patch& patch, const ShapeLimits& limits, int sweeps);

} // namespace quoin
