// Fewer faces in the same planes: borders are simplified and planes filled anew between them; or, where that does not
// go, by quadric edge contraction inside every plane, then along the borders, with every contraction checked against
// topology and orientation (Garland 1999; Wang & Guo 2019, section 3.2).
#pragma once

#include "base/param.h"
#include "mesh/plane_mesh.h"

#include <array>

namespace quoin {

// Qem: contraction inside the planes, then along borders. Remesh: borders, then every plane filled anew between them.
enum class SimplifyMethod { Qem, Remesh };
constexpr auto choice_names(SimplifyMethod) { return std::array{"qem", "remesh"}; }

struct SimplifyParams {
    SimplifyMethod method = SimplifyMethod::Remesh;
    double max_error = 0.008;
    double max_open_error = 0.02;
    double max_inner_error = 0.01;
    double max_border_shift = 0.02;
    double max_fold_error = 0.02;
    int face_budget = 0;
    double snap_distance = 0.02;
    double crease_angle = 10.0;
    double max_deviation = 30.0;
    double max_turn = 60.0;
    double min_shape = 0.02;
    double inner_ratio = 0.0;
    double border_ratio = 0.0;
    double face_weight = 1.0;
    double plane_weight = 1.0;
    double line_weight = 1.0;
    double point_weight = 0.001;
    bool improve_shape = true;
    double weld_distance = 1e-6;

    static constexpr auto list()
    {
        using P = SimplifyParams;
        return std::tuple{
            Param{"method", &P::method, "",
                  "how faces are taken away: quadric contraction, or planes filled anew between simplified borders"},
            Param{"max_error", &P::max_error, "m", "how far a border between planes may move out of either plane", 0.0,
                  10.0},
            Param{"max_open_error", &P::max_open_error, "m",
                  "how far an open border of the mesh may move; sensors leave it ragged", 0.0, 10.0},
            Param{"max_inner_error", &P::max_inner_error, "m",
                  "RMS distance to its dense faces that a vertex inside a plane may reach; keeps shapes no plane "
                  "explains; 0 = no bound",
                  0.0, 10.0},
            Param{"max_border_shift", &P::max_border_shift, "m",
                  "how far a border between planes may move inside them; straightens borders between nearly coplanar "
                  "planes",
                  0.0, 10.0},
            Param{
                "max_fold_error", &P::max_fold_error, "m",
                "how far the surface may move where faces that are folded onto each other, look away from their plane "
                "or have no area are taken out in the end; 0 = they stay",
                0.0, 10.0},
            Param{"face_budget", &P::face_budget, "",
                  "most faces of the result: errors double until they fit; 0 = no budget", 0.0, 1e9},
            Param{"snap_distance", &P::snap_distance, "m",
                  "how far vertices move onto their plane, crease or corner before anything is contracted; 0 = not at "
                  "all",
                  0.0, 1.0},
            Param{"crease_angle", &P::crease_angle, "deg",
                  "planes at less than this angle have no common line to move to", 0.1, 90.0},
            Param{"max_deviation", &P::max_deviation, "deg",
                  "angle between a face and its plane that is always allowed", 1.0, 180.0},
            Param{"max_turn", &P::max_turn, "deg",
                  "angle by which one contraction may turn a face that is farther from its plane's direction", 1.0,
                  180.0},
            Param{"min_shape", &P::min_shape, "", "height over longest edge below which no contraction makes a face",
                  0.0, 0.5},
            Param{"inner_ratio", &P::inner_ratio, "",
                  "qem: fraction of the vertices inside a plane that are kept at least", 0.0, 1.0},
            Param{"border_ratio", &P::border_ratio, "", "qem: fraction of the border edges that are kept at least", 0.0,
                  1.0},
            Param{"face_weight", &P::face_weight, "", "weight of the distance to the dense faces", 0.0, 1e6},
            Param{"plane_weight", &P::plane_weight, "", "weight of the distance to the planes of the clusters", 0.0,
                  1e6},
            Param{"line_weight", &P::line_weight, "", "weight of the distance to the dense border edges", 0.0, 1e6},
            Param{"point_weight", &P::point_weight, "",
                  "weight of the distance to the dense vertices; spreads vertices evenly", 1e-9, 1e6},
            Param{"improve_shape", &P::improve_shape, "", "flip edges inside planes towards a Delaunay triangulation"},
            Param{"weld_distance", &P::weld_distance, "m",
                  "vertices in one cell of a grid of this size become one first; 0 = none", 0.0, 0.01},
        };
    }
};

// Keeps the moments of all planes that keep faces; planes without faces are dropped and the ids of the others move up
// in order; parts of a plane that no longer hang together, or look away from it in the end, go over to a plane beside
// them or become planes of their own, behind the others. By remeshing, pieces of planes within one other plane become
// part of it where they are as small as a hole that is filled, and as close to it as a vertex inside it may be. Colours
// follow the vertices that stay, normals are dropped, classes are found anew. The result is manifold: vertices on edges
// of three or more faces, and where fans touch in a point, are split. It has no duplicate face. Faces that are folded
// onto each other, look away from their plane or have no area are taken out in the end where max_fold_error allows it;
// the rims of thin sheets stay folded. Faces with vertices that are not finite are dropped. Throws ImpossibleError if
// no face is left.
PlaneMesh simplify(PlaneMesh mesh, const SimplifyParams& params);

} // namespace quoin
