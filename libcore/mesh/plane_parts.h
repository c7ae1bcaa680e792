// Planes in one piece, with all their faces on their side.
#pragma once

#include "mesh/plane_mesh.h"

#include <functional>
#include <optional>
#include <vector>

namespace quoin {

// Are all corners of the faces within `distance` [m] of the plane, and does none of the faces look away from it?
bool explains(const TriangleMesh& mesh, const Plane& plane, const std::vector<FaceId>& faces, double distance);

// The plane behind the longest border of some faces that explains them. opposite: opposite_half_edges(mesh.mesh).
// plane_behind(f): the plane that a face on the other side of their border stands for, if any.
std::optional<PlaneId> plane_beside(const PlaneMesh& mesh, const std::vector<std::uint32_t>& opposite,
                                    const std::vector<FaceId>& faces, double distance,
                                    const std::function<std::optional<PlaneId>(FaceId)>& plane_behind);

// Joined: faces of a plane that hang together over edges are a part, whichever way they look. OneSided: those that look
// away from the plane are none with the others, and a plane that they keep or get is turned to face them: no face looks
// away from its plane in the end.
enum class PlaneParts { Joined, OneSided };

// Of the parts of a plane the largest keeps it, one that it faces before all others. The rest go over to the plane
// behind their longest border that has them within `distance` [m] and on its side, or become planes of their own, with
// the moments of their faces, behind all others. Classes of vertices are as they were.
void separate_parts(PlaneMesh& mesh, double distance, PlaneParts kind);

} // namespace quoin
