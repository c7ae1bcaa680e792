// Straight segments in photographs, matched to the borders between planes: the observations of the line term
// (Wang & Guo 2019, E_t).
#pragma once

#include "base/param.h"
#include "mesh/line_matches.h"
#include "mesh/plane_mesh.h"
#include "scan/keyframes.h"
#include "scan/scan.h"

#include <array>

namespace quoin {

enum class SegmentMethod { Lsd, EdLines, Guided };
constexpr auto choice_names(SegmentMethod) { return std::array{"lsd", "edlines", "guided"}; }

struct DetectLinesParams {
    SegmentMethod method = SegmentMethod::Lsd;
    double min_segment = 30.0;
    double lsd_scale = 0.8;
    double lsd_sigma = 0.6;
    double lsd_quantization = 2.0;
    double lsd_angle = 22.5;
    double lsd_density = 0.7;
    int lsd_bins = 1024;
    int edlines_gradient = 20;
    double edlines_sigma = 1.0;
    double edlines_fit_error = 1.0;
    int guided_reach = 12;
    double guided_step = 2.0;
    double guided_sigma = 1.0;
    double guided_gradient = 2.0;
    double guided_tolerance = 1.0;
    double guided_off_cost = 0.5;
    double guided_share = 0.6;
    double guided_log_alarms = 0.0;
    double min_plane_angle = 30.0;
    double min_border_length = 0.10;
    double max_border_gap = 0.03;
    double max_border_rms = 0.01;
    double match_distance = 10.0;
    double match_angle = 5.0;
    double min_overlap = 0.5;
    double sample_step = 4.0;
    int visible_radius = 2;
    double depth_tolerance = 0.01;
    double relative_depth_tolerance = 0.02;

    static constexpr auto list()
    {
        using P = DetectLinesParams;
        return std::tuple{
            Param{
                "method", &P::method, "",
                "LSD (von Gioi et al. 2010), EDLines (Akinlar and Topal 2011), or guided: a search beside each border"},
            Param{"min_segment", &P::min_segment, "px",
                  "least length of a segment in an image 640 px wide; grows with the root of the width", 1.0, 1e4},
            Param{"lsd_scale", &P::lsd_scale, "", "lsd: the image is reduced by this factor first", 0.1, 1.0},
            Param{"lsd_sigma", &P::lsd_sigma, "px", "lsd: blur before reduction, times 1 / lsd_scale", 0.0, 10.0},
            Param{"lsd_quantization", &P::lsd_quantization, "", "lsd: grey level error to expect", 0.0, 255.0},
            Param{"lsd_angle", &P::lsd_angle, "deg", "lsd: largest angle of a gradient to its segment", 1.0, 90.0},
            Param{"lsd_density", &P::lsd_density, "", "lsd: least share of aligned pixels in a segment's rectangle",
                  0.0, 1.0},
            Param{"lsd_bins", &P::lsd_bins, "", "lsd: bins in which gradients are sorted", 1.0, 65536.0},
            Param{"edlines_gradient", &P::edlines_gradient, "",
                  "edlines: least gradient of an edge pixel, in grey levels", 1.0, 255.0},
            Param{"edlines_sigma", &P::edlines_sigma, "px", "edlines: blur before detection", 0.1, 10.0},
            Param{"edlines_fit_error", &P::edlines_fit_error, "px",
                  "edlines: largest mean distance of edge pixels to their segment", 0.1, 10.0},
            Param{"guided_reach", &P::guided_reach, "px", "guided: how far from a border its edge is looked for", 1.0,
                  100.0},
            Param{"guided_step", &P::guided_step, "px", "guided: distance of the places along a border", 0.5, 100.0},
            Param{"guided_sigma", &P::guided_sigma, "px", "guided: blur across the border before the gradient", 0.3,
                  10.0},
            Param{"guided_gradient", &P::guided_gradient, "", "guided: least gradient of an edge, in grey levels a px",
                  0.0, 255.0},
            Param{"guided_tolerance", &P::guided_tolerance, "px", "guided: largest distance of an edge to its line",
                  0.1, 10.0},
            Param{"guided_off_cost", &P::guided_off_cost, "",
                  "guided: share of its votes that an edge loses that lies guided_reach from where it is expected", 0.0,
                  1.0},
            Param{"guided_share", &P::guided_share, "", "guided: least share of places that see the edge", 0.0, 1.0},
            Param{"guided_log_alarms", &P::guided_log_alarms, "",
                  "guided: largest decimal logarithm of the number of such edges expected by chance", -100.0, 100.0},
            Param{"min_plane_angle", &P::min_plane_angle, "deg", "least angle between the two planes of a border", 0.0,
                  90.0},
            Param{"min_border_length", &P::min_border_length, "m", "least length of a straight border", 0.0, 100.0},
            Param{"max_border_gap", &P::max_border_gap, "m", "a border goes on over gaps of at most this", 0.0, 10.0},
            Param{"max_border_rms", &P::max_border_rms, "m", "largest RMS distance of a straight border to its line",
                  0.0, 1.0},
            Param{"match_distance", &P::match_distance, "px",
                  "largest mean distance of a projected border to its segment", 0.0, 1000.0},
            Param{"match_angle", &P::match_angle, "deg", "largest angle between them", 0.0, 90.0},
            Param{"min_overlap", &P::min_overlap, "", "least overlap of the two, as a fraction of the shorter one", 0.0,
                  1.0},
            Param{"sample_step", &P::sample_step, "px",
                  "distance of the points at which the visibility of a border is tested", 0.5, 100.0},
            Param{"visible_radius", &P::visible_radius, "px",
                  "a border is visible where one of its planes shows within this distance", 0.0, 100.0},
            Param{"depth_tolerance", &P::depth_tolerance, "m", "and its depth differs by no more than this", 0.0, 1.0},
            Param{"relative_depth_tolerance", &P::relative_depth_tolerance, "", "plus this fraction of the depth", 0.0,
                  1.0},
        };
    }
};

// Matches of all keyframes, in their order. Each segment belongs to one border at most, and each visible stretch of a
// border to one segment: the nearest. Borders between the same two planes are cut where they bend. Throws what
// ScanImages throws, and InputError when a keyframe is no frame of the scan.
LineMatches detect_lines(const ScanImages& images, const Keyframes& keyframes, const PlaneMesh& mesh,
                         const DetectLinesParams& params);

} // namespace quoin
