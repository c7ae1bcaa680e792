#include "metrics/border_metrics.h"

#include "base/parallel.h"
#include "base/progress.h"
#include "image/sampling.h"
#include "mesh/adjacency.h"
#include "metrics/keyframe_sight.h"
#include "metrics/surface.h"
#include "metrics/texel_source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kHalfTexel = 0.5;
// Keyframes whose results are in memory at a time.
constexpr std::size_t kBatch = 32;

double luma(const Vector3f& color) { return Vector3f(0.299f, 0.587f, 0.114f).dot(color); }

// A place on an edge, with one point to either side of it.
struct Pair {
    std::array<SurfaceSample, 2> side;
    double texture_step = 0.0; // luma of the first less that of the second
    std::size_t stretch = 0;   // of an edge
};

struct Spacing {
    double step = 0.0;    // between pairs [m]
    double stretch = 0.0; // edges are cut into stretches no longer than this [m]
};

class EdgePairs {
public:
    explicit EdgePairs(const TexturedModel& model)
        : model_(model), mesh_(model.mesh().planes.mesh), opposite_(opposite_half_edges(mesh_))
    {
    }

    // Along all edges that `counts` (by their two half-edges), one after the other; the points are half a texel of the
    // coarser side apart from the edge. Pairs of which one point has no colour from photographs are left out.
    template <class Counts>
    std::vector<Pair> along(const Spacing& spacing, const Counts& counts) const
    {
        std::vector<Pair> pairs;
        double to_next = 0.5 * spacing.step;
        std::size_t first_stretch = 0;
        for (std::uint32_t h = 0; h < opposite_.size(); ++h) {
            const std::uint32_t other = opposite_[h];
            if (!is_half_edge(other) || other < h || !counts(h, other)) continue;
            const double length = (end(h) - start(h)).norm();
            const double stretches = std::ceil(length / spacing.stretch);
            for (; to_next < length; to_next += spacing.step)
                if (auto pair = pair_at(h, other, to_next / length)) {
                    pair->stretch = first_stretch + static_cast<std::size_t>(stretches * to_next / length);
                    pairs.push_back(*pair);
                }
            to_next -= length;
            first_stretch += static_cast<std::size_t>(stretches);
        }
        return pairs;
    }

private:
    Vector3d start(std::uint32_t half_edge) const
    {
        return corner(mesh_, half_edge / 3, static_cast<int>(half_edge % 3));
    }
    Vector3d end(std::uint32_t half_edge) const
    {
        return corner(mesh_, half_edge / 3, static_cast<int>((half_edge + 1) % 3));
    }
    double texel_size(FaceId f) const // [m]
    {
        const Vector2d a = model_.texel(f, Vector3d::UnitX()), ab = model_.texel(f, Vector3d::UnitY()) - a,
                       ac = model_.texel(f, Vector3d::UnitZ()) - a;
        return std::sqrt(face_area(mesh_, f) / (0.5 * std::abs(ab.x() * ac.y() - ab.y() * ac.x())));
    }

    // At a part of the way along `h`.
    std::optional<Pair> pair_at(std::uint32_t h, std::uint32_t other, double part) const
    {
        const Vector3d on_edge = start(h) + part * (end(h) - start(h));
        const double distance = kHalfTexel * std::max(texel_size(h / 3), texel_size(other / 3));
        const auto first = photographed_point(h, on_edge, distance),
                   second = photographed_point(other, on_edge, distance);
        if (!first || !second) return std::nullopt;
        return Pair{{*first, *second}, texture_luma(*first) - texture_luma(*second)};
    }
    std::optional<SurfaceSample> photographed_point(std::uint32_t half_edge, const Vector3d& on_edge,
                                                    double distance) const
    {
        const FaceId f = half_edge / 3;
        const Vector3d normal = face_normal(mesh_, f);
        const Vector3d inward = normal.cross(end(half_edge) - start(half_edge)).normalized();
        const Vector3d point = on_edge + distance * inward, weights = barycentric(mesh_, f, point);
        const Vector2d texel = model_.texel(f, weights);
        if (!texel.allFinite() || source_at(model_, f, texel) != TexelSource::Photograph) return std::nullopt;
        return SurfaceSample{point, normal, weights, f};
    }
    double texture_luma(const SurfaceSample& s) const
    {
        return luma(model_.sample(s.face, model_.texel(s.face, s.weights), 1.0));
    }

    const TexturedModel& model_;
    const TriangleMesh& mesh_;
    std::vector<std::uint32_t> opposite_;
};

double median_contrast(const std::vector<Pair>& pairs)
{
    std::vector<double> contrasts;
    for (const Pair& pair : pairs)
        contrasts.push_back(std::abs(pair.texture_step));
    return median(std::move(contrasts));
}

// What a keyframe shows of a pair.
struct PhotographedStep {
    double resolution = 0.0; // of the less resolved point [px/m]; 0 where it does not see both
    double step = 0.0;       // luma in the common exposure
};

std::vector<PhotographedStep> steps_in_keyframe(const std::vector<Pair>& pairs, const Evaluated& inputs, std::size_t k,
                                                const EvaluateParams& params)
{
    const KeyframeSight sight(inputs, k, params);
    const ColorImage image = inputs.images->color(inputs.keyframes->frame[k]);
    const Alignment& alignment = *inputs.alignment;
    const auto common_luma = [&](const Vector2d& pixel) {
        const auto light = static_cast<float>(
            alignment.vignetting.correction(Vignetting::squared_radius(image.width, image.height, pixel)));
        // Bilinear samples need a neighbour on every side.
        const double x = std::clamp(pixel.x(), 0.0, image.width - 1.001),
                     y = std::clamp(pixel.y(), 0.0, image.height - 1.001);
        return luma(light * alignment.gain[k].cwiseProduct(sample_color(image, x, y)) + alignment.bias[k]);
    };
    std::vector<PhotographedStep> result(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto first = sight.look(pairs[i].side[0]), second = sight.look(pairs[i].side[1]);
        if (!first || !second) continue;
        result[i] = {std::min(first->resolution, second->resolution),
                     common_luma(first->pixel) - common_luma(second->pixel)};
    }
    return result;
}

std::vector<PhotographedStep> best_steps(const std::vector<Pair>& pairs, const Evaluated& inputs,
                                         const EvaluateParams& params)
{
    const std::size_t count = inputs.keyframes->frame.size();
    std::vector<PhotographedStep> best(pairs.size());
    Progress progress("looking at borders", count);
    for (std::size_t first = 0; first < count; first += kBatch) {
        std::vector<std::vector<PhotographedStep>> by_keyframe(std::min(kBatch, count - first));
        parallel_for(by_keyframe.size(), [&](std::size_t i) {
            by_keyframe[i] = steps_in_keyframe(pairs, inputs, first + i, params);
            progress.step();
        });
        for (const auto& steps : by_keyframe)
            for (std::size_t i = 0; i < best.size(); ++i)
                if (steps[i].resolution > best[i].resolution) best[i] = steps[i];
    }
    return best;
}

// Of the means over stretches, each as often as it has pairs.
double median_added_step(const std::vector<Pair>& pairs, const Evaluated& inputs, const EvaluateParams& params)
{
    const auto photographed = best_steps(pairs, inputs, params);
    std::vector<double> added;
    for (std::size_t first = 0, end = 0; first < pairs.size(); first = end) {
        double sum = 0.0;
        std::size_t count = 0;
        for (; end < pairs.size() && pairs[end].stretch == pairs[first].stretch; ++end)
            if (photographed[end].resolution > 0.0) {
                sum += pairs[end].texture_step - photographed[end].step;
                ++count;
            }
        added.insert(added.end(), count, std::abs(sum / static_cast<double>(count)));
    }
    return median(std::move(added));
}

} // namespace

void add_border_metrics(MetricList& list, const TexturedModel& model, const Evaluated& inputs,
                        const EvaluateParams& params)
{
    const TexturedMesh& mesh = model.mesh();
    const EdgePairs edge_pairs(model);
    const auto plane = [&](std::uint32_t h) { return mesh.planes.face_plane[h / 3]; };
    const auto is_border = [&](std::uint32_t h, std::uint32_t other) { return plane(h) != plane(other); };
    const auto lies_on_uv_of = [&](std::uint32_t h, std::uint32_t other) {
        const auto& corners = mesh.corner_uv[other / 3];
        return std::ranges::count(corners, mesh.corner_uv[h / 3][h % 3]) +
                   std::ranges::count(corners, mesh.corner_uv[h / 3][(h + 1) % 3]) ==
               2;
    };
    const Spacing spacing{params.crease_step, params.border_stretch};
    const auto at_borders = edge_pairs.along(spacing, is_border);
    const auto inside = edge_pairs.along(
        spacing, [&](std::uint32_t h, std::uint32_t other) { return !is_border(h, other) && lies_on_uv_of(h, other); });
    if (inputs.can_look_from_keyframes()) {
        list.lower("texture.border_step", "", median_added_step(at_borders, inputs, params));
        list.plain("texture.inner_step", "", median_added_step(inside, inputs, params));
    }
    list.plain("texture.border_contrast", "", median_contrast(at_borders));
    list.plain("texture.inner_contrast", "", median_contrast(inside));
}

} // namespace quoin
