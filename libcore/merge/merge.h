// Joining of neighbouring clusters that are one plane in the world.
#pragma once

#include "base/param.h"
#include "mesh/plane_mesh.h"

namespace quoin {

struct MergeParams {
    bool angle_test = true;
    double max_angle = 15.0;
    bool distance_test = true;
    double max_distance = 0.008;
    bool energy_rule = true;
    double max_energy_increase = 0.1;
    double energy_area_ratio = 0.1;
    double energy_max_distance = 0.02;
    double energy_max_angle = 60.0;
    bool island_rule = true;
    double island_border_share = 0.8;
    double island_max_distance = 0.02;
    double island_max_angle = 80.0;
    double island_max_area = 0.02;
    bool absorb_rule = true;
    double absorb_area = 0.003;
    double absorb_max_distance = 0.02;
    double absorb_max_angle = 80.0;
    int robust_rounds = 5;
    double tukey = 4.685;
    bool regularize = true;
    double regular_angle = 1.0;
    double regular_depth = 0.005;
    double regular_sigmas = 3.0;
    double regular_reach = 45.0;
    double regular_area = 0.5;
    double regular_open = 5.0;
    double regular_move = 0.002;

    static constexpr auto list()
    {
        using P = MergeParams;
        return std::tuple{
            Param{"angle_test", &P::angle_test, "", "neighbours of one plane must have close normals"},
            Param{"max_angle", &P::max_angle, "deg", "largest angle between the normals of such neighbours", 0.0,
                  180.0},
            Param{"distance_test", &P::distance_test, "", "neighbours of one plane must lie close to it"},
            Param{"max_distance", &P::max_distance, "m",
                  "largest RMS distance of both to their common plane, and of the smaller to the larger one's plane",
                  0.0, 1.0},
            Param{"energy_rule", &P::energy_rule, "",
                  "also join a small cluster that hardly raises the energy of a large one: bumps, whose normals mean "
                  "nothing"},
            Param{"max_energy_increase", &P::max_energy_increase, "",
                  "energy rule: largest increase, relative to the large cluster's energy", 0.0, 1e3},
            Param{"energy_area_ratio", &P::energy_area_ratio, "",
                  "energy rule: largest area of the small cluster, relative to the large one's; 1 = no guard", 0.0,
                  1.0},
            Param{"energy_max_distance", &P::energy_max_distance, "m",
                  "energy rule: largest RMS distance of the small cluster to the large one's plane", 0.0, 10.0},
            Param{"energy_max_angle", &P::energy_max_angle, "deg",
                  "energy rule: largest angle between the normals; a bump is no step", 0.0, 180.0},
            Param{"island_rule", &P::island_rule, "", "also join a small cluster that another one surrounds"},
            Param{"island_border_share", &P::island_border_share, "",
                  "island rule: least share of the small cluster's border with that one neighbour", 0.0, 1.0},
            Param{"island_max_distance", &P::island_max_distance, "m",
                  "island rule: largest RMS distance of the small cluster to the other's plane", 0.0, 10.0},
            Param{"island_max_angle", &P::island_max_angle, "deg", "island rule: largest angle between the normals",
                  0.0, 180.0},
            Param{"island_max_area", &P::island_max_area, "m^2", "island rule: largest area of the small cluster", 0.0,
                  100.0},
            Param{"absorb_rule", &P::absorb_rule, "",
                  "also join tiny clusters to the neighbour whose plane is nearest"},
            Param{"absorb_area", &P::absorb_area, "m^2", "absorption: clusters of less area are tiny", 0.0, 100.0},
            Param{"absorb_max_distance", &P::absorb_max_distance, "m",
                  "absorption: largest RMS distance of the tiny cluster to the neighbour's plane", 0.0, 10.0},
            Param{"absorb_max_angle", &P::absorb_max_angle, "deg",
                  "absorption: largest angle between the normals, or faces would look away from their plane", 0.0,
                  180.0},
            Param{"robust_rounds", &P::robust_rounds, "",
                  "reweightings of the plane fit of joined clusters; 0 = least squares", 0.0, 100.0},
            Param{"tukey", &P::tukey, "",
                  "faces farther from the plane than this many standard deviations do not count", 1.0, 100.0},
            Param{"regularize", &P::regularize, "",
                  "turn narrow planes that were probably meant to be parallel or orthogonal to better known ones"},
            Param{"regular_angle", &P::regular_angle, "deg",
                  "standard deviation of what was meant to be parallel or orthogonal; less = a stronger prior", 0.01,
                  45.0},
            Param{"regular_depth", &P::regular_depth, "m",
                  "error of a plane across its extent, which tells how well its direction is known", 1e-5, 1.0},
            Param{"regular_sigmas", &P::regular_sigmas, "",
                  "planes count as parallel or orthogonal within this many standard deviations of both", 0.0, 10.0},
            Param{"regular_reach", &P::regular_reach, "deg", "and within this angle", 0.0, 45.0},
            Param{"regular_area", &P::regular_area, "m^2",
                  "planes of at least this area give their directions to all others, smaller ones to neighbours", 0.0,
                  1e3},
            Param{"regular_open", &P::regular_open, "deg",
                  "planes turn whose direction is known better than this along them and worse across", 0.0, 90.0},
            Param{"regular_move", &P::regular_move, "m",
                  "how much farther from their plane faces may be then, RMS; but for steps between parallel planes",
                  0.0, 1.0},
        };
    }
};

// Rules run one after the other, each over all pairs of neighbours in the order of their RMS distance, best first, with
// sums that follow every join: planes (angle and distance; the rules of Wang & Guo 2018), energy (their rule of 2019),
// islands, tiny clusters. Normals are compared with their sign, so the two sides of a thin sheet stay apart. All faces
// stay; planes are renumbered in the order of their first face; moments add; planes of joined clusters are fitted anew,
// and in the end regularised. Borders are looked for among the vertices whose class is not Inner. Throws InputError
// when the parts of `mesh` do not fit together.
PlaneMesh merge_planes(PlaneMesh mesh, const MergeParams& params);

} // namespace quoin
