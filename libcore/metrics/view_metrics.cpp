#include "metrics/view_metrics.h"

#include "base/parallel.h"
#include "base/progress.h"
#include "image/sampling.h"
#include "metrics/image_quality.h"
#include "metrics/refine_pose.h"
#include "metrics/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct NamedModel {
    std::string name;
    std::function<RenderedView(const Camera&, const Rigid&, int supersampling)> render;
};

// What one view says of one model.
struct ViewScore {
    double coverage = 0, psnr_raw = 0, psnr = 0, psnr_charged = 0, psnr_shown = 0, ssim_raw = 0, ssim = 0,
           ssim_charged = 0, sharpness = 0, shift = 0;
};

std::vector<FrameId> chosen_views(const Scan& scan, int most)
{
    std::vector<FrameId> held_out;
    for (const FrameId id : scan.frames_held_out())
        if (scan.frames[id].has_color()) held_out.push_back(id);
    if (most == 0 || held_out.size() <= static_cast<std::size_t>(most)) return held_out;
    std::vector<FrameId> chosen;
    for (int i = 0; i < most; ++i)
        chosen.push_back(held_out[held_out.size() * static_cast<std::size_t>(i) / static_cast<std::size_t>(most)]);
    return chosen;
}

TargetView load_target(const Evaluated& inputs, FrameId id)
{
    const Scan& scan = *inputs.scan;
    TargetView target;
    target.color = inputs.images->color(id);
    target.gray = to_gray(target.color);
    target.depth = inputs.images->depth(id);
    target.color_camera = inputs.alignment ? inputs.alignment->color : scan.color;
    target.depth_camera = scan.depth;
    target.depth_from_color = inputs.alignment ? inputs.alignment->depth_from_color : scan.depth_from_color;
    return target;
}

Mask drawn_pixels(const RenderedView& view)
{
    Mask mask(view.depth.width, view.depth.height);
    for (std::size_t i = 0; i < mask.pixels.size(); ++i)
        mask.pixels[i] = view.depth.pixels[i] > 0.0f;
    return mask;
}

// Pixels that show the model, not far from the measured depth where there is some.
Mask covered_pixels(const RenderedView& view, const TargetView& target, double tolerance)
{
    Mask mask(view.depth.width, view.depth.height);
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x) {
            const double z = view.depth.at(x, y);
            if (z <= 0.0) continue;
            mask.at(x, y) = 1;
            if (target.depth.empty()) continue;
            const Vector3d q = target.depth_from_color * Vector3d(target.color_camera.ray(Vector2d(x, y)) * z);
            if (q.z() <= 0.0) continue;
            const Vector2d u = target.depth_camera.project(q);
            if (!target.depth_camera.contains(u)) continue;
            const double measured =
                target.depth.at(static_cast<int>(std::lround(u.x())), static_cast<int>(std::lround(u.y())));
            if (measured > 0.0 && std::abs(measured - q.z()) > tolerance * std::max(1.0, q.z())) mask.at(x, y) = 0;
        }
    return mask;
}

// Pixels of the photograph that a measured depth falls on or beside.
Mask measured_pixels(const TargetView& target)
{
    Mask mask(target.color.width, target.color.height, 0);
    const Rigid color_from_depth = target.depth_from_color.inverse();
    for (int y = 0; y < target.depth.height; ++y)
        for (int x = 0; x < target.depth.width; ++x) {
            const double z = target.depth.at(x, y);
            if (z <= 0.0) continue;
            const Vector3d p = color_from_depth * Vector3d(target.depth_camera.ray(Vector2d(x, y)) * z);
            if (p.z() <= 0.0) continue;
            const Vector2d at = target.color_camera.project(p);
            if (!target.color_camera.contains(at)) continue;
            const int left = static_cast<int>(std::floor(at.x())), top = static_cast<int>(std::floor(at.y()));
            for (int v = std::max(top, 0); v <= std::min(top + 1, mask.height - 1); ++v)
                for (int u = std::max(left, 0); u <= std::min(left + 1, mask.width - 1); ++u)
                    mask.at(u, v) = 1;
        }
    return mask;
}

// Loses the light that the lens loses towards the corners: of all models, as the alignment of one has found it.
void darken(ColorImage& image, const Vignetting& vignetting)
{
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const double light =
                1.0 / vignetting.correction(Vignetting::squared_radius(image.width, image.height, {x, y}));
            for (auto& channel : image.at(x, y))
                channel = static_cast<std::uint8_t>(std::clamp(std::lround(light * channel), 0L, 255L));
        }
}

void add(Mask& mask, const Mask& other)
{
    for (std::size_t i = 0; i < mask.pixels.size(); ++i)
        mask.pixels[i] = mask.pixels[i] || other.pixels[i];
}

// Where models are to show something: where a depth was measured, and where all of them do; in a view without depth,
// where any of them does.
Mask charged_pixels(const TargetView& target, const std::vector<Mask>& covered, const Mask& common)
{
    Mask mask = common;
    if (!target.depth.empty())
        add(mask, measured_pixels(target));
    else
        for (const Mask& of_model : covered)
            add(mask, of_model);
    return mask;
}

double share(const Mask& mask)
{
    return static_cast<double>(std::count(mask.pixels.begin(), mask.pixels.end(), 1)) /
           static_cast<double>(mask.pixels.size());
}

ColorImage blackened(ColorImage image, const Mask& mask)
{
    for (std::size_t i = 0; i < mask.pixels.size(); ++i)
        if (!mask.pixels[i]) image.pixels[i] = {0, 0, 0};
    return image;
}

// charged: where the model is to show something. psnr_charged is of black where it shows nothing or what is not there,
// psnr_shown of what a viewer sees: black where it shows nothing.
ViewScore score_view(const RenderedView& view, const ColorImage& photo, const Mask& covered, const Mask& common,
                     const Mask& charged)
{
    const ColorImage fitted = apply_color(fit_affine_color(view.color, photo, common), view.color);
    const ColorImage own = apply_color(fit_affine_color(view.color, photo, covered), view.color);
    const ColorImage covering = blackened(own, covered);
    ViewScore score;
    score.coverage = share(covered);
    score.psnr_raw = psnr(view.color, photo, common);
    score.psnr = psnr(fitted, photo, common);
    score.psnr_charged = psnr(covering, photo, charged);
    score.psnr_shown = psnr(blackened(own, drawn_pixels(view)), photo, charged);
    score.ssim_raw = ssim(view.color, photo, common);
    score.ssim = ssim(fitted, photo, common);
    score.ssim_charged = ssim(covering, photo, charged);
    score.sharpness = gradient_ratio(fitted, photo, common);
    return score;
}

std::vector<ViewScore> score_frame(const Evaluated& inputs, const std::vector<NamedModel>& models, FrameId id,
                                   const EvaluateParams& params)
{
    const TargetView target = load_target(inputs, id);
    const Rigid start = target.depth_from_color.inverse() * inputs.scan->frames[id].camera_from_world;
    std::vector<RenderedView> views;
    std::vector<Mask> covered;
    std::vector<double> shift;
    Mask common(target.color.width, target.color.height, 1);
    for (const NamedModel& model : models) {
        const auto draft = [&](const Camera& camera, const Rigid& color_from_world) {
            return model.render(camera, color_from_world, 1);
        };
        const Rigid pose = refine_pose(target, draft, start, params.refine_rounds);
        shift.push_back((pose.inverse().translation() - start.inverse().translation()).norm());
        views.push_back(model.render(target.color_camera, pose, params.supersampling));
        if (inputs.alignment) darken(views.back().color, inputs.alignment->vignetting);
        covered.push_back(covered_pixels(views.back(), target, params.depth_tolerance));
        for (std::size_t i = 0; i < common.pixels.size(); ++i)
            common.pixels[i] = common.pixels[i] && covered.back().pixels[i];
    }
    const Mask charged = charged_pixels(target, covered, common);
    std::vector<ViewScore> scores;
    for (std::size_t m = 0; m < models.size(); ++m) {
        scores.push_back(score_view(views[m], target.color, covered[m], common, charged));
        scores.back().shift = shift[m];
    }
    return scores;
}

// Mean over the views that have the figure.
double mean_of(const std::vector<std::vector<ViewScore>>& scores, std::size_t model, double ViewScore::*figure)
{
    double sum = 0.0, count = 0.0;
    for (const auto& view : scores)
        if (const double value = view[model].*figure; std::isfinite(value)) sum += value, count += 1.0;
    return count > 0.0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

std::vector<NamedModel> models_of(const Evaluated& inputs, const std::optional<TexturedModel>& textured)
{
    std::vector<NamedModel> models;
    if (textured)
        models.push_back({"model", [&](const Camera& camera, const Rigid& pose, int samples) {
                              return render_textured(*textured, camera, pose, samples);
                          }});
    if (inputs.dense && !inputs.dense->color.empty())
        models.push_back({"dense", [&](const Camera& camera, const Rigid& pose, int samples) {
                              return render_colored(*inputs.dense, camera, pose, samples);
                          }});
    return models;
}

} // namespace

void add_view_metrics(MetricList& list, const Evaluated& inputs, const EvaluateParams& params)
{
    if (!inputs.scan || !inputs.images) return;
    std::optional<TexturedModel> textured;
    if (inputs.textured) textured.emplace(*inputs.textured);
    const std::vector<NamedModel> models = models_of(inputs, textured);
    const std::vector<FrameId> frames = chosen_views(*inputs.scan, params.views);
    if (models.empty() || frames.empty()) return;
    std::vector<std::vector<ViewScore>> scores(frames.size());
    Progress progress("rendering held-out views", frames.size());
    parallel_for(frames.size(), [&](std::size_t i) {
        scores[i] = score_frame(inputs, models, frames[i], params);
        progress.step();
    });
    list.plain("views.count", "", static_cast<double>(frames.size()));
    for (std::size_t m = 0; m < models.size(); ++m) {
        const std::string name = "views." + models[m].name;
        list.higher(name + ".coverage", "", mean_of(scores, m, &ViewScore::coverage));
        list.higher(name + ".psnr", "dB", mean_of(scores, m, &ViewScore::psnr));
        list.higher(name + ".psnr_raw", "dB", mean_of(scores, m, &ViewScore::psnr_raw));
        list.higher(name + ".psnr_charged", "dB", mean_of(scores, m, &ViewScore::psnr_charged));
        list.higher(name + ".psnr_shown", "dB", mean_of(scores, m, &ViewScore::psnr_shown));
        list.higher(name + ".ssim", "", mean_of(scores, m, &ViewScore::ssim));
        list.higher(name + ".ssim_raw", "", mean_of(scores, m, &ViewScore::ssim_raw));
        list.higher(name + ".ssim_charged", "", mean_of(scores, m, &ViewScore::ssim_charged));
        list.plain(name + ".gradient_ratio", "", mean_of(scores, m, &ViewScore::sharpness));
        list.plain(name + ".pose_shift", "mm", mean_of(scores, m, &ViewScore::shift) * kMillimetres);
    }
}

} // namespace quoin
