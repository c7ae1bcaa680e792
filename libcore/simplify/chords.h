// Who may join border vertices. Planes are simplified in parallel, each knowing its own faces only; an edge or face
// whose vertices all lie on borders could be made by two of them at once. So of the planes that share these vertices
// only the one of the smallest id may make it, and only if no face has it already.
#pragma once

#include "mesh/adjacency.h"
#include "mesh/creases.h"

namespace quoin {

class Chords {
public:
    explicit Chords(const PlaneMesh& mesh);
    bool may_join(PlaneId plane, VertexId a, VertexId b) const;
    bool may_fill(PlaneId plane, const Face& face) const;
    // Do all faces on the edge lie in the plane?
    bool inside(PlaneId plane, VertexId a, VertexId b) const;

private:
    const PlaneMesh& mesh_;
    VertexFaces around_;
    VertexPlanes planes_;
};

} // namespace quoin
