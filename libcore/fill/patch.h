// What may close a hole: faces over vertices of the mesh and a few new ones.
#pragma once

#include "fill/border_loops.h"
#include "fill/fill_holes.h"
#include "mesh/creases.h"

#include <array>
#include <optional>
#include <vector>

namespace quoin {

struct Patch {
    std::vector<Eigen::Vector3d> vertex; // new ones, with ids from the mesh's vertex count on
    std::vector<Face> face;
    std::vector<PlaneId> plane; // of each face
};

// A closed polygon of vertex ids and their positions, counter-clockwise around what it encloses.
struct Outline {
    std::vector<VertexId> vertex;
    std::vector<Eigen::Vector3d> position;
};

// Enclosed area along the normal: negative for an outline that runs clockwise. Is a point within the outline?
double signed_area(const Outline& outline, const Eigen::Vector3d& normal); // [m^2]
bool encloses(const Outline& outline, const Plane& plane, const Eigen::Vector3d& point);

// Triangles over the vertices of `outline`, less `islands` within it (which run clockwise), in the direction of
// `plane`'s normal. None when the outlines cross or touch in the plane, or nothing is enclosed.
std::optional<std::vector<Face>> triangulate_on_plane(const Outline& outline, const std::vector<Outline>& islands,
                                                      const Plane& plane);

// Triangles over a loop in space that fold least (Liepa 2003), also against the faces on its edges, whose third corners
// are `beside`; none when that fails.
std::optional<std::vector<Face>> triangulate_in_space(const Outline& outline,
                                                      const std::vector<Eigen::Vector3d>& beside);

// Finds how loops of a mesh may be closed: on one plane, on two up to the line where they meet, on three up to their
// corner, or, when the loop is small, by any faces. The first way is taken by which no face is folded onto another or
// looks away from its plane; the first of all if there is none. What the scan saw is not asked.
class Proposer {
public:
    Proposer(const PlaneMesh& mesh, const std::vector<BorderLoop>& loops, const FillHolesParams& params);
    std::optional<Patch> propose(const BorderLoop& loop) const;
    // For a loop whose last edge, of kNoPlane and without a face, is no border and stays open.
    std::optional<Patch> propose_bay(const BorderLoop& loop) const;

private:
    std::vector<PlaneId> candidates_of(const BorderLoop& loop) const;
    std::optional<Patch> on_one_plane(const BorderLoop& loop, PlaneId plane) const;
    std::optional<Patch> between_planes(const BorderLoop& loop, const std::vector<PlaneId>& planes) const;
    std::optional<Patch> anyhow(const BorderLoop& loop) const;
    bool is_clean(const BorderLoop& loop, const Patch& patch) const;
    bool lies_on(const BorderLoop& loop, PlaneId plane) const;

    const PlaneMesh& mesh_;
    const FillHolesParams& params_;
    VertexPlanes vertex_planes_;
    std::vector<std::vector<Outline>> islands_; // by plane: outer borders of pieces that lie on it
};

// With new vertices behind those of the mesh.
Eigen::Vector3d position_of(const PlaneMesh& mesh, const Patch& patch, VertexId v);
std::array<Eigen::Vector3d, 3> corners_of(const PlaneMesh& mesh, const Patch& patch, const Face& face);

Outline outline_of(const PlaneMesh& mesh, const BorderLoop& loop);

} // namespace quoin
