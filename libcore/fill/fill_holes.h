// Closes what the scan left open although something must be there: holes in planes, gaps where planes meet, and small
// holes of any shape. What a ray of a keyframe passed through stays open, as do borders around which nothing closes.
#pragma once

#include "base/param.h"
#include "mesh/filled.h"
#include "mesh/plane_mesh.h"
#include "scan/alignment.h"
#include "scan/keyframes.h"
#include "scan/scan.h"

#include <tuple>

namespace quoin {

struct FillHolesParams {
    bool enabled = true;
    double plane_distance = 0.02;
    double max_area = 1.5;
    double max_gap = 0.25;
    double min_angle = 20.0;
    double max_rest_border = 0.6;
    double sample_distance = 0.02;
    double depth_tolerance = 0.05;
    double depth_noise = 0.0015;
    int min_views = 2;
    double max_open = 0.05;

    static constexpr auto list()
    {
        using P = FillHolesParams;
        return std::tuple{
            Param{"enabled", &P::enabled, "", "closes holes; false hands the mesh through"},
            Param{"plane_distance", &P::plane_distance, "m",
                  "a hole lies on a plane when all of its border is this near to it", 0.0005, 0.5},
            Param{"max_area", &P::max_area, "m^2", "larger holes stay open", 0.0, 100.0},
            Param{"max_gap", &P::max_gap, "m",
                  "planes are extended to where they meet when all of the hole's border is this near to each of them",
                  0.0, 10.0},
            Param{"sample_distance", &P::sample_distance, "m", "distance of the points at which rays are asked for",
                  0.002, 0.5},
            Param{"depth_tolerance", &P::depth_tolerance, "m",
                  "a ray that ends this far behind a point has passed through it", 0.001, 1.0},
            Param{"depth_noise", &P::depth_noise, "1/m",
                  "standard deviation of the sensor's depth over its square; the tolerance is at least three of them",
                  0.0, 1.0},
            Param{"min_views", &P::min_views, "", "keyframes that must have looked through a point for it to be open",
                  1, 1000},
            Param{"max_open", &P::max_open, "", "part of a hole that may be open for it to be closed", 0.0, 1.0},
        };
    }
};

struct FillHolesInput {
    const PlaneMesh& planes;
    const ScanImages& images;
    const Keyframes& keyframes;
    const Alignment& alignment;
};

// The mesh's vertices and faces first, and behind them what closes holes. Edges keep at most two faces, no face is
// folded onto another one, looks away from its plane or parts a plane that was not so before; new vertices lie where
// planes meet, planes and moments stay. Throws InputError when keyframes and alignment do not belong together or a
// depth image cannot be read.
Filled<PlaneMesh> fill_holes(const FillHolesInput& input, const FillHolesParams& params);

} // namespace quoin
