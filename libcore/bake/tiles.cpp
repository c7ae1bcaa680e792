#include "bake/tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quoin {
namespace {

constexpr std::size_t kSamplesPerTile = 16;
constexpr float kLeastConsistency = 1e-3f;    // a lone dissenter is better than no colour
constexpr float kLeastDetail = 0.0038f;       // less than each of four tiles gives where they meet, 1/4^4
constexpr double kMedianToDeviation = 1.4826; // of a normal distribution
constexpr int kLabelRounds = 20;
static_assert(kSamplesPerTile <= std::numeric_limits<SampleSet>::digits);

int tiles_along(int texels) { return (texels + kTileSize - 1) / kTileSize; }

// Inside texels of a tile; the texels of the chart's rim where it has no others.
std::vector<Eigen::Vector2i> texels_of_tile(const TexelChart& texels, int column, int row)
{
    std::vector<Eigen::Vector2i> inside, rim;
    for (int y = row * kTileSize; y < std::min((row + 1) * kTileSize, texels.height()); ++y)
        for (int x = column * kTileSize; x < std::min((column + 1) * kTileSize, texels.width()); ++x) {
            if (texels.inside.at(x, y))
                inside.emplace_back(x, y);
            else if (texels.face.at(x, y) != kNoFace)
                rim.emplace_back(x, y);
        }
    return inside.empty() ? rim : inside;
}

double weighted_median(std::vector<std::pair<double, double>> value_weight)
{
    std::ranges::sort(value_weight);
    double total = 0.0;
    for (const auto& [value, weight] : value_weight)
        total += weight;
    double sum = 0.0;
    for (const auto& [value, weight] : value_weight) {
        sum += weight;
        if (sum >= 0.5 * total) return value;
    }
    return value_weight.back().first;
}

void rate_tile(std::vector<TileView>& views, double deviation)
{
    std::vector<double> distance(views.size(), 0.0);
    double spread = 0.0;
    for (int channel = 0; channel < 3; ++channel) {
        std::vector<std::pair<double, double>> colors, distances;
        for (const auto& view : views)
            colors.emplace_back(view.color[channel], view.quality);
        const double median = weighted_median(colors);
        for (const auto& view : views)
            distances.emplace_back(std::abs(view.color[channel] - median), view.quality);
        for (std::size_t i = 0; i < views.size(); ++i)
            distance[i] = std::max(distance[i], distances[i].first);
        spread = std::max(spread, kMedianToDeviation * weighted_median(distances));
    }
    const double sigma = std::max(deviation, spread);
    for (std::size_t i = 0; i < views.size(); ++i) {
        const double d = distance[i] / sigma;
        views[i].consistency = std::max(kLeastConsistency, static_cast<float>(std::exp(-0.5 * d * d)));
    }
}

std::array<std::uint32_t, 4> neighbour_labels(const ChartTiles& tiles, int column, int row)
{
    const auto label = [&](int c, int r) {
        return c < 0 || r < 0 || c >= tiles.columns || r >= tiles.rows ? kNoView : tiles.label[tiles.index(c, r)];
    };
    return {label(column - 1, row), label(column + 1, row), label(column, row - 1), label(column, row + 1)};
}

std::uint32_t best_label(const ChartTiles& tiles, int column, int row, double smoothness)
{
    const auto around = neighbour_labels(tiles, column, row);
    std::uint32_t best = kNoView;
    double best_cost = std::numeric_limits<double>::infinity();
    for (const auto& view : tiles.view[tiles.index(column, row)]) {
        double cost = -std::log(static_cast<double>(view.worth()));
        for (const auto other : around)
            if (other != kNoView && other != view.keyframe) cost += smoothness;
        if (cost >= best_cost) continue;
        best_cost = cost;
        best = view.keyframe;
    }
    return best;
}

// nullptr when the keyframe does not see the tile.
const TileView* find_view(const std::vector<TileView>& views, std::uint32_t keyframe)
{
    const auto it = std::ranges::lower_bound(views, keyframe, {}, &TileView::keyframe);
    return it != views.end() && it->keyframe == keyframe ? &*it : nullptr;
}

float detail_weight(const TileView& view, const TileView& labelled, double detail_quality)
{
    if (view.keyframe == labelled.keyframe) return 1.0f;
    const double share = static_cast<double>(view.worth()) / labelled.worth();
    return detail_quality < 1.0
               ? static_cast<float>(std::clamp((share - detail_quality) / (1.0 - detail_quality), 0.0, 1.0))
               : 0.0f;
}

} // namespace

TileSamples::TileSamples(const PlaneMesh& planes, const TexelChart& texels)
    : columns_(tiles_along(texels.width())), rows_(tiles_along(texels.height())), density_(texels.chart.density),
      sample_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_))
{
    const TexelPositions positions(planes, texels);
    Eigen::AlignedBox3d box;
    for (std::size_t tile = 0; tile < sample_.size(); ++tile) {
        const int column = static_cast<int>(tile) % columns_, row = static_cast<int>(tile) / columns_;
        const auto candidates = texels_of_tile(texels, column, row);
        const std::size_t count = std::min(candidates.size(), kSamplesPerTile);
        for (std::size_t i = 0; i < count; ++i) {
            const auto& at = candidates[(2 * i + 1) * candidates.size() / (2 * count)];
            const auto face = texels.face.at(at.x(), at.y());
            sample_[tile].push_back({positions.world(face, at.x(), at.y()), positions.normal(face)});
            box.extend(sample_[tile].back().p_world);
        }
    }
    if (box.isEmpty()) return;
    centre_ = box.center();
    radius_ = 0.5 * box.diagonal().norm();
}

ChartTiles TileSamples::empty_tiles() const
{
    ChartTiles tiles;
    tiles.columns = columns_;
    tiles.rows = rows_;
    tiles.view.resize(sample_.size());
    tiles.label.resize(sample_.size(), kNoView);
    tiles.last_view.resize(sample_.size());
    for (const auto& samples : sample_)
        tiles.unseen.push_back(static_cast<SampleSet>((1u << samples.size()) - 1u));
    return tiles;
}

TileSamples::Judgement TileSamples::judge_tile(const TextureView& view, std::size_t tile) const
{
    Judgement judgement;
    TileView& result = judgement.view;
    double seen = 0.0, quality = 0.0;
    std::array<TextureView::Aim, kSamplesPerTile> aim;
    for (std::size_t i = 0; i < sample_[tile].size(); ++i)
        view.aim({sample_[tile][i].p_world, Eigen::Vector3d::Zero(), sample_[tile][i].normal_world}, Margins::Least,
                 std::span(&aim[i], 1));
    for (std::size_t i = 0; i < sample_[tile].size(); ++i) {
        const auto [by_least_margins, sighting] = view.see_by_both(aim[i]);
        judgement.by_least_margins |= by_least_margins;
        if (!sighting) continue;
        judgement.seen |= static_cast<SampleSet>(1u << i);
        const double resolution = std::min(1.0, sighting->resolution / density_);
        quality +=
            resolution * resolution * std::sqrt(sighting->facing) * sighting->trust * view.centring(sighting->pixel);
        result.color += view.color(*sighting, density_);
        seen += 1.0;
    }
    if (seen == 0.0) return judgement;
    result.color /= static_cast<float>(seen);
    // A view that shows half of a tile leaves a seam inside it.
    const double part = seen / static_cast<double>(sample_[tile].size());
    result.quality = static_cast<float>(quality / seen * part * part * view.sharpness() * view.sharpness());
    return judgement;
}

void TileSamples::judge(const TextureView& view, std::uint32_t keyframe, ChartTiles& tiles) const
{
    if (!view.may_see(centre_, radius_)) return;
    for (std::size_t tile = 0; tile < sample_.size(); ++tile) {
        auto [judged, seen, by_least_margins] = judge_tile(view, tile);
        if (by_least_margins) tiles.last_view[tile].push_back(keyframe);
        tiles.unseen[tile] &= static_cast<SampleSet>(~seen);
        if (!(judged.quality > 0.0f)) continue;
        judged.keyframe = keyframe;
        tiles.view[tile].push_back(judged);
    }
}

RowAims::RowAims(const TextureView& view, const TexelChart& texels, const TexelPositions& positions,
                 const TexelRow& row, Margins margins)
    : row_(row)
{
    const int y = row.first.y(), last = std::min(row.first.x() + row.count, texels.width());
    for (int begin = row.first.x(), end = begin; begin < last; begin = end) {
        const auto face = texels.face.at(begin, y);
        std::size_t count = 0;
        for (; end < last && texels.face.at(end, y) == face; end += row.stride)
            ++count;
        if (face == kNoFace) continue;
        const auto p_world = [&](int x) {
            const Eigen::Vector2f at = row.place(x);
            return positions.world(face, at.x(), at.y());
        };
        const PointRow points{p_world(begin), p_world(begin + row.stride) - p_world(begin), positions.normal(face)};
        view.aim(points, margins, {&aim_[static_cast<std::size_t>((begin - row.first.x()) / row.stride)], count});
    }
}

void keep_last_views_of_gaps(ChartTiles& tiles)
{
    for (std::size_t tile = 0; tile < tiles.unseen.size(); ++tile)
        if (tiles.unseen[tile] == 0) tiles.last_view[tile] = {};
}

void rate_consistency(ChartTiles& tiles, double deviation)
{
    for (auto& views : tiles.view)
        if (!views.empty()) rate_tile(views, deviation);
}

void choose_labels(ChartTiles& tiles, double smoothness)
{
    bool changed = true;
    for (int round = 0; round <= kLabelRounds && changed; ++round) {
        changed = false;
        // The first round ignores neighbours: each tile starts from its own best view.
        const double weight = round == 0 ? 0.0 : smoothness;
        for (int row = 0; row < tiles.rows; ++row)
            for (int column = 0; column < tiles.columns; ++column) {
                auto& label = tiles.label[tiles.index(column, row)];
                const auto best = best_label(tiles, column, row, weight);
                changed |= best != label;
                label = best;
            }
    }
}

TileWeights::TileWeights(const ChartTiles& tiles, std::uint32_t keyframe, double detail_quality)
    : columns_(tiles.columns), rows_(tiles.rows), consistency_(tiles.view.size(), 0.0f),
      detail_(tiles.view.size(), 0.0f)
{
    for (std::size_t tile = 0; tile < tiles.view.size(); ++tile) {
        const TileView* view = find_view(tiles.view[tile], keyframe);
        if (!view) continue;
        consistency_[tile] = view->consistency;
        any_view_ = true;
        const float weight = detail_weight(*view, *find_view(tiles.view[tile], tiles.label[tile]), detail_quality);
        detail_[tile] = std::sqrt(std::sqrt(weight));
        any_detail_ |= weight > 0.0f;
    }
}

TileWeights::Row TileWeights::detail(int column, int texel_y) const
{
    Row weights = row(detail_, column, texel_y);
    for (float& w : weights) {
        w = w * w * w * w;
        if (w < kLeastDetail) w = 0.0f;
    }
    return weights;
}

bool TileWeights::is_positive_near(const std::vector<float>& weight, int column, int row) const
{
    for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r)
        for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column + 1); ++c)
            if (weight[index(c, r)] > 0.0f) return true;
    return false;
}

TileWeights::Row TileWeights::row(const std::vector<float>& weight, int column, int texel_y) const
{
    constexpr auto kSize = static_cast<float>(kTileSize);
    const float y =
        std::clamp((static_cast<float>(texel_y) + 0.5f) / kSize - 0.5f, 0.0f, static_cast<float>(rows_ - 1));
    const int y0 = static_cast<int>(y), y1 = std::min(y0 + 1, rows_ - 1);
    const float fy = y - static_cast<float>(y0);
    // In the left half of a tile towards the one before, in the right half towards the next.
    Row result;
    const auto mix = [&](int first_texel, int left) {
        const int x0 = std::max(left, 0), x1 = std::min(left + 1, columns_ - 1);
        const float upper_left = weight[index(x0, y0)], upper_right = weight[index(x1, y0)];
        const float lower_left = weight[index(x0, y1)], lower_right = weight[index(x1, y1)];
        for (int i = first_texel; i < first_texel + kTileSize / 2; ++i) {
            const float fx = (static_cast<float>(i) + 0.5f) / kSize + (first_texel == 0 ? 0.5f : -0.5f);
            result[static_cast<std::size_t>(i)] =
                (1 - fy) * ((1 - fx) * upper_left + fx * upper_right) + fy * ((1 - fx) * lower_left + fx * lower_right);
        }
    };
    mix(0, column - 1);
    mix(kTileSize / 2, column);
    return result;
}

} // namespace quoin
