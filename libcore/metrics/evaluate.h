// Every figure that the report and the ablation table show.
#pragma once

#include "base/metrics.h"
#include "base/param.h"
#include "mesh/ground_truth.h"
#include "mesh/textured_mesh.h"
#include "scan/alignment.h"
#include "scan/keyframes.h"
#include "scan/scan.h"

#include <cstdint>
#include <string>
#include <vector>

namespace quoin {

struct EvaluateParams {
    int samples = 100000;
    double reach = 0.5;
    bool align = true;
    int observed_views = 3;
    double match_distance = 0.03;
    double match_angle = 30.0;
    double plane_area = 0.05;
    double crease_tolerance = 0.01;
    double crease_angle = 20.0;
    double crease_length = 0.1;
    double crease_step = 0.01;
    double border_stretch = 0.1;
    int views = 0;
    int refine_rounds = 3;
    double depth_tolerance = 0.05;
    int supersampling = 2;
    double seen_min_depth = 0.3;
    double seen_max_depth = 8.0;
    double seen_angle = 80.0;

    bool observed(const TrueSample& sample) const { return sample.views >= static_cast<std::uint32_t>(observed_views); }

    static constexpr auto list()
    {
        using P = EvaluateParams;
        return std::tuple{
            Param{"samples", &P::samples, "", "surface points for distances, spread evenly over the area", 100.0, 1e8},
            Param{"reach", &P::reach, "m", "distances beyond count as this", 0.01, 100.0},
            Param{"align", &P::align, "", "move the model rigidly onto the ground truth before it is measured"},
            Param{"observed_views", &P::observed_views, "", "true points that fewer frames saw are not asked for", 1.0,
                  1000.0},
            Param{"match_distance", &P::match_distance, "m",
                  "a true point and a model point farther apart do not match", 0.001, 1.0},
            Param{"match_angle", &P::match_angle, "deg", "nor do they when their normals differ by more", 1.0, 90.0},
            Param{"plane_area", &P::plane_area, "m^2", "true planes of which the scan saw less are not asked for", 0.0,
                  100.0},
            Param{"crease_tolerance", &P::crease_tolerance, "m", "creases this near to each other are the same", 0.0005,
                  0.5},
            Param{"crease_angle", &P::crease_angle, "deg", "edges between planes that turn by less are no creases", 0.0,
                  90.0},
            Param{"crease_length", &P::crease_length, "m", "shorter true creases are not asked for", 0.0, 10.0},
            Param{"crease_step", &P::crease_step, "m",
                  "distance of the points at which creases, and colours to both sides of borders, are compared", 0.001,
                  1.0},
            Param{
                "border_stretch", &P::border_stretch, "m",
                "length of a border between planes over which what the baking added to its step of colour is averaged",
                0.001, 10.0},
            Param{"views", &P::views, "", "largest number of held-out views to render, evenly chosen; 0 = all", 0.0,
                  100000.0},
            Param{"refine_rounds", &P::refine_rounds, "",
                  "rounds of fitting a held-out view's pose to the model; 0 = keep the scan's", 0.0, 20.0},
            Param{"depth_tolerance", &P::depth_tolerance, "m",
                  "a pixel whose rendered depth is this far from the measured one is not covered, and a point this far "
                  "from it not seen; in metres of depth beyond the first, as many times that",
                  0.001, 1.0},
            Param{"supersampling", &P::supersampling, "", "samples along each side of a rendered pixel", 1.0, 8.0},
            Param{"seen_min_depth", &P::seen_min_depth, "m", "nearest surface that a keyframe sees", 0.0, 10.0},
            Param{"seen_max_depth", &P::seen_max_depth, "m", "farthest surface that a keyframe sees", 0.1, 1000.0},
            Param{"seen_angle", &P::seen_angle, "deg",
                  "a keyframe that looks at a surface more obliquely does not see it", 10.0, 90.0},
        };
    }
};

// What there is to measure; absent things are null and their figures are left out.
struct Evaluated {
    const Scan* scan = nullptr;
    const ScanImages* images = nullptr; // with scan, for views
    const Keyframes* keyframes = nullptr;
    const TriangleMesh* dense = nullptr;
    const PlaneMesh* planes = nullptr;
    const Alignment* alignment = nullptr;
    const TexturedMesh* textured = nullptr;
    const GroundTruth* truth = nullptr;
    std::vector<std::uint8_t> face_filled; // of the light model; 1 = closes a hole. Empty: none is known to

    // The light model: the textured mesh's, or else the plane mesh.
    const PlaneMesh* model() const { return textured ? &textured->planes : planes; }
    // Are there the keyframes' images and aligned poses?
    bool can_look_from_keyframes() const { return scan && images && keyframes && alignment; }
};

// Lengths in millimetres, angles in degrees. Groups: size, hygiene, geometry, planes, creases, poses, exposure,
// texture, views. Against a dense mesh, which has nothing there, faces that close holes are left out of
// geometry.accuracy; against the truth they count. Throws UsageError when there is no mesh at all, InputError when
// inputs do not belong together.
Metrics evaluate(const Evaluated& inputs, const EvaluateParams& params);

// The figures as lines for a person: name, value, unit, and which way is better.
std::string metrics_table(const Metrics& metrics);

} // namespace quoin
