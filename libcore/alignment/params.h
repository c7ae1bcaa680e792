#pragma once

#include "base/param.h"

#include <array>

namespace quoin {

// Alternating: the paper's schedule. Joint: poses, planes and colours in one Levenberg-Marquardt system over an image
// pyramid.
enum class AlignmentSolver { Alternating, Joint };
constexpr auto choice_names(AlignmentSolver) { return std::array{"alternating", "joint"}; }

// What holds the planes: the moments of the dense mesh, or the sampled points of the simplified mesh (the paper).
enum class PlaneTermKind { Moments, Texels };
constexpr auto choice_names(PlaneTermKind) { return std::array{"moments", "texels"}; }

// Fixed: lambda_p as given. Balanced: times E_c / E_p of the input, as the paper's authors do.
enum class PlaneWeight { Fixed, Balanced };
constexpr auto choice_names(PlaneWeight) { return std::array{"fixed", "balanced"}; }

// Reprojection: distance of the projected crease to the segment [px]. Depth: distance of the segment's depth to both
// planes (the paper).
enum class LineTermKind { Reprojection, Depth };
constexpr auto choice_names(LineTermKind) { return std::array{"reprojection", "depth"}; }

// Refine: focal length, principal point and position of the colour camera, shared by all frames.
enum class CalibrationUse { Auto, Fixed, Refine };
constexpr auto choice_names(CalibrationUse) { return std::array{"auto", "fixed", "refine"}; }

struct OptimizeTextureParams {
    AlignmentSolver solver = AlignmentSolver::Joint;
    double lambda_p = 1.0;
    PlaneWeight plane_weight = PlaneWeight::Fixed;
    PlaneTermKind plane_term = PlaneTermKind::Moments;
    double lambda_t = 1.0;
    LineTermKind line_term = LineTermKind::Reprojection;
    double lambda_d = 4.0;
    bool optimize_poses = true;
    bool optimize_planes = true;
    bool optimize_exposure = true;
    bool optimize_vignetting = true;
    CalibrationUse calibration = CalibrationUse::Auto;
    bool keep_frame = true;

    int levels = 3;
    double texel_size = 0.0033;
    int texel_stride = 3;
    double selected = 0.2;
    double uniform = 0.05;
    double min_gradient = 0.01;
    int bucket = 16;
    double smoothing = 0.7;
    double held_out = 0.1;
    double certainty = 2.0;
    double min_texture = 0.02;

    int visibility_rounds = 2;
    int iterations = 8;
    int cg_iterations = 60;
    double cg_tolerance = 0.01;
    double damping = 1e-4;
    int damping_trials = 4;
    double min_decrease = 1e-4;
    int outer_loops = 10;
    int pose_loops = 5;
    int plane_loops = 2;

    bool estimate_noise = true;
    double sigma_color = 0.02;
    double huber_color = 0.03;
    double sigma_plane = 0.0055;
    double shared_area = 0.02;
    double sigma_line = 1.0;
    double huber_line = 2.0;
    double depth_noise = 0.0012;
    double depth_noise_floor = 0.002;
    double huber_depth = 0.7;
    double prior_translation = 0.02;
    double prior_rotation = 1.0;
    double shared_errors = 16.0;
    double exposure_prior = 0.0003;
    double bias_prior = 0.01;
    int exposure_rounds = 3;
    double prior_focal = 0.03;
    double prior_center = 10.0;
    double prior_camera_translation = 0.03;
    double prior_camera_rotation = 1.0;

    double min_depth = 0.3;
    double max_depth = 6.0;
    double border = 5.0;
    double min_cosine = 0.2;
    double depth_tolerance = 0.02;
    double depth_jump = 0.05;
    int jump_radius = 3;
    double depth_gate = 0.05;
    int depth_stride = 8;
    double saturation = 0.02;
    double min_line_angle = 20.0;
    double max_line_distance = 3.0;
    double line_step = 2.0;
    int min_observations = 200;
    int min_plane_observations = 50;
    double max_translation = 0.3;
    double max_rotation = 10.0;
    double max_increase = 0.1;
    double max_tilt = 0.005;

    static constexpr auto list() // NOLINT(readability-function-size): a table, one entry a parameter
    {
        using P = OptimizeTextureParams;
        return std::tuple{
            Param{"solver", &P::solver, "",
                  "alternating: the paper's blocks in turn; joint: one system over an image pyramid"},
            Param{"lambda_p", &P::lambda_p, "", "weight of the plane term E_p; 0 = off", 0.0, 1e9},
            Param{"plane_weight", &P::plane_weight, "", "lambda_p as given, or times E_c/E_p of the input"},
            Param{"plane_term", &P::plane_term, "", "E_p over the dense clusters' moments or over sampled points"},
            Param{"lambda_t", &P::lambda_t, "", "weight of the line term E_t; 0 = off", 0.0, 1e9},
            Param{"line_term", &P::line_term, "", "E_t in the image or by the depth along the segment"},
            Param{"lambda_d", &P::lambda_d, "", "weight of the raw depth's point-to-plane term; 0 = off", 0.0, 1e9},
            Param{"optimize_poses", &P::optimize_poses, "", "move the cameras"},
            Param{"optimize_planes", &P::optimize_planes, "", "move the planes"},
            Param{"optimize_exposure", &P::optimize_exposure, "", "estimate a gain and a bias per frame and channel"},
            Param{"optimize_vignetting", &P::optimize_vignetting, "",
                  "with optimize_exposure: estimate the light that the lens loses towards the corners"},
            Param{"calibration", &P::calibration, "",
                  "keep the colour camera or refine it for all frames; auto refines it where colours agree clearly "
                  "better then"},
            Param{"keep_frame", &P::keep_frame, "",
                  "move the whole solution rigidly back to where its planes lie closest to the dense mesh"},
            Param{"levels", &P::levels, "", "levels of the image pyramid of the joint solver", 1, 6},
            Param{"texel_size", &P::texel_size, "m", "size of a texel", 1e-4, 1.0},
            Param{"texel_stride", &P::texel_stride, "", "use every n-th texel along both axes; doubles with each level",
                  1, 1000},
            Param{"selected", &P::selected, "", "largest part of the texels kept, by gradient (joint)", 0.0, 1.0},
            Param{"uniform", &P::uniform, "", "part of the texels kept whatever their gradient (joint)", 0.0, 1.0},
            Param{"min_gradient", &P::min_gradient, "1/px", "least grey gradient of a selected texel (joint)", 0.0,
                  1.0},
            Param{"bucket", &P::bucket, "", "the best texels are chosen in squares of so many texels", 1, 10000},
            Param{"smoothing", &P::smoothing, "px", "sigma of the Gaussian laid over every level", 0.0, 10.0},
            Param{"held_out", &P::held_out, "",
                  "part of the texels that the solver does not see: its result is judged by them; 0 = no judgement",
                  0.0, 0.9},
            Param{
                "certainty", &P::certainty, "",
                "the input is kept if the views of held-out texels differ more after than before, by so many standard "
                "errors",
                0.0, 1e9},
            Param{"min_texture", &P::min_texture, "",
                  "part of the texels with a gradient of min_gradient below which the scan has no texture to align by",
                  0.0, 1.0},
            Param{"visibility_rounds", &P::visibility_rounds, "", "how often a level looks anew who sees what (joint)",
                  1, 100},
            Param{"iterations", &P::iterations, "", "largest number of joint steps per round", 1, 1000},
            Param{"cg_iterations", &P::cg_iterations, "", "conjugate gradient steps per joint step", 1, 10000},
            Param{"cg_tolerance", &P::cg_tolerance, "", "relative residual at which conjugate gradients stop", 0.0,
                  1.0},
            Param{"damping", &P::damping, "", "first Levenberg-Marquardt damping; 0 = Gauss-Newton", 0.0, 1.0},
            Param{"damping_trials", &P::damping_trials, "",
                  "tries with ten times the damping before a step is given up", 1, 20},
            Param{"min_decrease", &P::min_decrease, "", "relative decrease of the energy below which a loop ends", 0.0,
                  1.0},
            Param{"outer_loops", &P::outer_loops, "", "rounds of poses, planes and colours (alternating)", 0, 1000},
            Param{"pose_loops", &P::pose_loops, "", "pose steps per round (alternating)", 0, 1000},
            Param{"plane_loops", &P::plane_loops, "", "plane steps per round (alternating)", 0, 1000},
            Param{"estimate_noise", &P::estimate_noise, "",
                  "take depths, and greys where they agree better than by sigma_color, to be as exact as they agree, "
                  "before they are weighed against the input's poses and planes (joint)"},
            Param{"sigma_color", &P::sigma_color, "", "noise of a grey value, 0..1", 1e-6, 1.0},
            Param{"huber_color", &P::huber_color, "", "grey difference from which the cost is linear; 1 = never", 1e-6,
                  1.0},
            Param{"sigma_plane", &P::sigma_plane, "m", "error of the dense mesh, which its cameras' errors have bent",
                  1e-6, 1.0},
            Param{"shared_area", &P::shared_area, "m^2",
                  "so much of the dense mesh errs together: the points of larger planes count as those of such a part",
                  1e-9, 1e9},
            Param{"sigma_line", &P::sigma_line, "px", "noise of a segment's end point", 1e-3, 100.0},
            Param{"huber_line", &P::huber_line, "", "line residual, in sigmas, from which the cost is linear", 1e-3,
                  1e9},
            Param{"depth_noise", &P::depth_noise, "1/m", "noise of a depth z is depth_noise_floor + depth_noise z^2",
                  0.0, 1.0},
            Param{"depth_noise_floor", &P::depth_noise_floor, "m", "noise of a near depth", 1e-6, 1.0},
            Param{"huber_depth", &P::huber_depth, "", "depth residual, in sigmas, from which the cost is linear", 1e-3,
                  1e9},
            Param{"prior_translation", &P::prior_translation, "m", "expected error of the input positions", 1e-6, 1e6},
            Param{"prior_rotation", &P::prior_rotation, "deg", "expected error of the input rotations", 1e-6, 1e6},
            Param{"shared_errors", &P::shared_errors, "",
                  "so many observations of a frame err together: the pull to its input pose counts once for each lot",
                  1.0, 1e9},
            Param{"exposure_prior", &P::exposure_prior, "", "pull of the gains to 1, per observation", 0.0, 1e6},
            Param{
                "bias_prior", &P::bias_prior, "",
                "pull of the biases to 0, per observation; black levels drift little, and a frame of one dark surface "
                "does not tell bias from gain",
                0.0, 1e6},
            Param{"exposure_rounds", &P::exposure_rounds, "", "reweighted solutions for the exposures", 1, 1000},
            Param{"prior_focal", &P::prior_focal, "", "expected relative error of the focal length", 1e-9, 1.0},
            Param{"prior_center", &P::prior_center, "px", "expected error of the principal point", 1e-9, 1e4},
            Param{"prior_camera_translation", &P::prior_camera_translation, "m", "expected error between the cameras",
                  1e-9, 10.0},
            Param{"prior_camera_rotation", &P::prior_camera_rotation, "deg", "expected error between the cameras", 1e-9,
                  90.0},
            Param{"min_depth", &P::min_depth, "m", "nearest texel that is used", 0.01, 100.0},
            Param{"max_depth", &P::max_depth, "m", "farthest texel that is used", 0.01, 1000.0},
            Param{"border", &P::border, "px", "margin of the images that is not used", 1.0, 1000.0},
            Param{"min_cosine", &P::min_cosine, "", "least cosine between view and plane normal", 0.0, 1.0},
            Param{"depth_tolerance", &P::depth_tolerance, "m",
                  "largest difference to the seen depth; at least 3 sigma of it", 0.0, 10.0},
            Param{"depth_jump", &P::depth_jump, "m",
                  "step between neighbouring depths that is an edge; at least 3 sigma", 0.0, 10.0},
            Param{"jump_radius", &P::jump_radius, "px", "distance to depth edges that is not used", 0, 100},
            Param{"depth_gate", &P::depth_gate, "m", "largest distance of a depth to its plane in the depth term", 0.0,
                  10.0},
            Param{"depth_stride", &P::depth_stride, "px", "the depth term takes every n-th pixel of both axes", 1,
                  1000},
            Param{"saturation", &P::saturation, "", "grey values this near to black or white are not used", 0.0, 0.49},
            Param{"min_line_angle", &P::min_line_angle, "deg", "least angle between the two planes of a line", 0.1,
                  90.0},
            Param{"max_line_distance", &P::max_line_distance, "px",
                  "a segment farther from its crease is left out until a round brings them closer (line_term "
                  "reprojection)",
                  0.0, 1e9},
            Param{"line_step", &P::line_step, "px", "distance of the points along a segment (line_term depth)", 0.5,
                  1000.0},
            Param{"min_observations", &P::min_observations, "", "a frame with fewer texels and depths stays as it is",
                  1, 1e9},
            Param{"min_plane_observations", &P::min_plane_observations, "", "a plane with fewer stays as it is", 1,
                  1e9},
            Param{"max_translation", &P::max_translation, "m", "a frame that would move farther stays as it was", 0.0,
                  1e6},
            Param{"max_rotation", &P::max_rotation, "deg", "a frame that would turn farther stays as it was", 0.0,
                  180.0},
            Param{"max_increase", &P::max_increase, "",
                  "a frame whose own energy grows by a larger part stays as it was", 0.0, 1e9},
            Param{
                "max_tilt", &P::max_tilt, "m",
                "RMS distance to its dense cluster that a plane may add by a turn beyond max_rotation, or it keeps its "
                "normal",
                0.0, 1e6},
        };
    }
};

} // namespace quoin
