#include "bake/level_seams.h"

#include "bake/distance_field.h"
#include "bake/fill.h"
#include "base/parallel.h"
#include "mesh/adjacency.h"

#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

// Bilinear colour of a chart at texel coordinates.
Eigen::Vector3f sample(const Image<Eigen::Vector3f>& image, const Eigen::Vector2d& texel)
{
    const double x = std::clamp(texel.x(), 0.0, image.width - 1.0), y = std::clamp(texel.y(), 0.0, image.height - 1.0);
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const int x1 = std::min(x0 + 1, image.width - 1), y1 = std::min(y0 + 1, image.height - 1);
    const auto fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
    return (1 - fy) * ((1 - fx) * image.at(x0, y0) + fx * image.at(x1, y0)) +
           fy * ((1 - fx) * image.at(x0, y1) + fx * image.at(x1, y1));
}

// A stretch of a chart's border with the correction that its colours need there.
struct Correction {
    Eigen::Vector3d from_world, to_world; // [m]
    Eigen::Vector3f shift = Eigen::Vector3f::Zero();
};

// 1 for small steps, falling to 0 where a step is a change of material (Tukey's biweight).
float trust(const Eigen::Vector3f& difference, double step)
{
    const auto r = static_cast<float>(difference.cwiseAbs().maxCoeff() / step);
    return r < 1.0f ? (1.0f - r * r) * (1.0f - r * r) : 0.0f;
}

class SeamFinder {
public:
    SeamFinder(const PlaneMesh& planes, const Atlas& atlas, const SeamOptions& options,
               const std::vector<ChartColors>& colors)
        : mesh_(planes.mesh), atlas_(atlas), options_(options), colors_(colors),
          opposite_(opposite_half_edges(planes.mesh))
    {
    }

    std::vector<Correction> corrections(std::uint32_t chart) const
    {
        std::vector<Correction> result;
        for (const FaceId f : atlas_.chart[chart].chart.face)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const auto other = opposite_[3 * std::size_t{f} + k];
                if (!is_half_edge(other) || atlas_.face_chart[other / 3] == chart) continue;
                add_edge(chart, atlas_.face_chart[other / 3],
                         {corner(mesh_, f, static_cast<int>(k)), corner(mesh_, f, static_cast<int>((k + 1) % 3))},
                         result);
            }
        return result;
    }

private:
    using Edge = std::pair<Eigen::Vector3d, Eigen::Vector3d>;

    void add_edge(std::uint32_t chart, std::uint32_t other, const Edge& edge, std::vector<Correction>& result) const
    {
        const Eigen::Vector3d along = edge.second - edge.first;
        const int segments = std::max(1, static_cast<int>(std::lround(along.norm() / options_.segment)));
        for (int i = 0; i < segments; ++i) {
            Correction part{edge.first + along * i / segments, edge.first + along * (i + 1) / segments};
            const Eigen::Vector3f difference = mean(other, part) - mean(chart, part);
            part.shift = 0.5f * trust(difference, options_.step) * difference;
            result.push_back(part);
        }
    }

    Eigen::Vector3f mean(std::uint32_t chart, const Correction& part) const
    {
        const TexelChart& texels = atlas_.chart[chart];
        const Eigen::Vector2d from = texels.texel(part.from_world), to = texels.texel(part.to_world);
        const int samples = std::max(1, static_cast<int>(std::ceil((to - from).norm())));
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        for (int i = 0; i < samples; ++i)
            sum += sample(colors_[chart].color, from + (to - from) * (i + 0.5) / samples);
        return sum / static_cast<float>(samples);
    }

    const TriangleMesh& mesh_;
    const Atlas& atlas_;
    const SeamOptions& options_;
    const std::vector<ChartColors>& colors_;
    std::vector<std::uint32_t> opposite_;
};

// The corrections at the texels under the border, and no correction farther than `reach` texels from it.
Image<WeightedColor> known_shifts(const TexelChart& texels, const std::vector<Correction>& corrections, double reach)
{
    Image<WeightedColor> known(texels.width(), texels.height());
    Image<float> distance(texels.width(), texels.height(), static_cast<float>(texels.width() + texels.height()));
    for (const auto& part : corrections) {
        const Eigen::Vector2d from = texels.texel(part.from_world), to = texels.texel(part.to_world);
        const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm())));
        for (int i = 0; i <= steps; ++i) {
            const Eigen::Vector2d at = from + (to - from) * i / steps;
            const int x = std::clamp(static_cast<int>(std::lround(at.x())), 0, texels.width() - 1);
            const int y = std::clamp(static_cast<int>(std::lround(at.y())), 0, texels.height() - 1);
            known.at(x, y).add(part.shift, 1.0f);
            distance.at(x, y) = 0.0f;
        }
    }
    const auto far = grow_distances(std::move(distance), static_cast<float>(texels.width() + texels.height()));
    for (std::size_t i = 0; i < known.pixels.size(); ++i)
        if (far.pixels[i] > static_cast<float>(reach)) known.pixels[i].add(Eigen::Vector3f::Zero(), 1.0f);
    return known;
}

} // namespace

void level_seams(const PlaneMesh& planes, const Atlas& atlas, const SeamOptions& options,
                 std::vector<ChartColors>& colors)
{
    const SeamFinder seams(planes, atlas, options, colors);
    std::vector<std::vector<Correction>> corrections(atlas.chart.size());
    parallel_for(corrections.size(),
                 [&](std::size_t c) { corrections[c] = seams.corrections(static_cast<std::uint32_t>(c)); });
    parallel_for(corrections.size(), [&](std::size_t c) {
        if (corrections[c].empty()) return;
        const TexelChart& texels = atlas.chart[c];
        const auto shifts = push_pull(known_shifts(texels, corrections[c], options.width * texels.chart.density));
        for (std::size_t i = 0; i < shifts.pixels.size(); ++i)
            colors[c].color.pixels[i] += shifts.pixels[i];
    });
}

} // namespace quoin
