// Partition of a dense mesh into near-planar clusters of connected faces, and a robust plane for each.
#pragma once

#include "base/param.h"
#include "mesh/plane_mesh.h"

#include <array>

namespace quoin {

enum class GrowthMethod { Heap, Hybrid, RegionGrowing };
constexpr auto choice_names(GrowthMethod) { return std::array{"heap", "hybrid", "region-growing"}; }

struct PartitionParams {
    int clusters = 0;
    double floater_area = 0.005;
    double max_error = 0.005;
    GrowthMethod method = GrowthMethod::Hybrid;
    double min_facing = 0.5;
    double max_part_angle = 80.0;
    int round_faces = 24;
    int round_reserve = 6;
    double grow_angle = 30.0;
    int refine_rounds = 8;
    double border_distance = 0.003;
    int robust_rounds = 5;
    double tukey = 4.685;
    double plausible_extent = 100.0;

    static constexpr auto list()
    {
        using P = PartitionParams;
        return std::tuple{
            Param{"clusters", &P::clusters, "", "clusters to stop at; 0 = stop by max_error instead", 0.0, 1e9},
            Param{"floater_area", &P::floater_area, "m^2",
                  "components of the mesh with less area do not count as clusters", 0.0, 1e3},
            Param{"max_error", &P::max_error, "m",
                  "largest RMS distance of a cluster, and of the parts it grows from, to its plane while clusters = 0",
                  0.0, 1.0},
            Param{"method", &P::method, "",
                  "how clusters grow: exact greedy, mutual best neighbours then exact greedy, or from seeds then exact "
                  "greedy"},
            Param{
                "min_facing", &P::min_facing, "",
                "least length of a cluster's mean face normal, so that no cluster holds both sides of a sheet; 0 = off",
                0.0, 1.0},
            Param{"max_part_angle", &P::max_part_angle, "deg",
                  "largest angle between the mean normals of a cluster and of either part it grows from while clusters "
                  "= 0",
                  0.0, 180.0},
            Param{"round_faces", &P::round_faces, "",
                  "hybrid: mean faces of a cluster at which the exact greedy phase takes over", 1.0, 1e6},
            Param{"round_reserve", &P::round_reserve, "",
                  "hybrid: the exact greedy phase begins with at least this multiple of `clusters`", 2.0, 1e3},
            Param{"grow_angle", &P::grow_angle, "deg", "region-growing: largest angle between a face and its region",
                  0.0, 90.0},
            Param{"refine_rounds", &P::refine_rounds, "",
                  "how often the faces on the borders may change sides on average; 0 = no refinement", 0.0, 1e3},
            Param{"border_distance", &P::border_distance, "m",
                  "straight borders are worth this distance of a face to its plane; 0 = energy alone", 0.0, 0.1},
            Param{"robust_rounds", &P::robust_rounds, "", "reweightings of the plane fit; 0 = least squares", 0.0,
                  100.0},
            Param{"tukey", &P::tukey, "",
                  "faces farther from the plane than this many standard deviations do not count", 1.0, 100.0},
            Param{"plausible_extent", &P::plausible_extent, "m",
                  "a larger mesh is warned about: it may be in millimetres", 1.0, 1e6,
                  ParamFlags{.affects_result = false}},
        };
    }
};

// Clusters are connected over shared edges (three or more faces on one edge are all neighbours) and grow by the least
// increase of the energy of geometry/pca_energy.h; their borders are then refined. The result holds the same vertices
// and faces, planes in the order of their first face, normals to the side that the faces face. With `clusters` set
// there are as many besides one for each floater (a raw scan's thousands of floaters would use them up), or more where
// other components or `min_facing` forbid to join further. Degenerate and duplicate faces are allowed. Throws
// InputError when a face uses a vertex that does not exist or is not finite, and ImpossibleError when no face has an
// area.
PlaneMesh partition(TriangleMesh mesh, const PartitionParams& params);

} // namespace quoin
