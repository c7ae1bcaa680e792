#include "bake/blend.h"

#include "bake/last_views.h"
#include "bake/low_band.h"
#include "bake/residual_shifts.h"
#include "bake/tiles.h"
#include "base/parallel.h"
#include "base/progress.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>

namespace quoin {
namespace {

// Keyframes in memory at a time; fixed, for their number must not depend on the threads.
constexpr std::size_t kBatch = 8;

constexpr int kStride = 2; // divides kTileSize
static_assert(kTileSize % kStride == 0);

// Views in memory from the first reading to the second, as far as they go.
constexpr std::size_t kKeptBytes = std::size_t{600} << 20;

struct Batch {
    std::size_t first = 0; // keyframe of view[0]
    std::vector<std::optional<TextureView>> view;
};

// All keyframes, a few at a time.
class Batches {
public:
    Batches(const BakeInput& input, const BakeTextureParams& params) : input_(input), params_(params) {}

    void for_each(const std::string& part, const std::function<void(const Batch&)>& use)
    {
        const std::size_t count = input_.keyframes.frame.size();
        Progress progress(part, count);
        for (std::size_t first = 0; first < count; first += kBatch) {
            const std::size_t size = std::min(kBatch, count - first);
            if (first / kBatch < kept_.size()) {
                use(kept_[first / kBatch]);
            } else {
                Batch batch = load(first, size);
                use(batch);
                if (first / kBatch == kept_.size()) keep(std::move(batch));
            }
            progress.step(size);
        }
    }

private:
    Batch load(std::size_t first, std::size_t count) const
    {
        Batch batch{first, std::vector<std::optional<TextureView>>(count)};
        parallel_for(count, [&](std::size_t i) { batch.view[i].emplace(input_, first + i, params_); });
        return batch;
    }

    void keep(Batch batch)
    {
        std::size_t bytes = 0;
        for (const auto& view : batch.view)
            bytes += view->bytes();
        if (kept_bytes_ + bytes > kKeptBytes) return;
        kept_bytes_ += bytes;
        kept_.push_back(std::move(batch));
    }

    const BakeInput& input_;
    const BakeTextureParams& params_;
    std::vector<Batch> kept_; // the first ones
    std::size_t kept_bytes_ = 0;
};

// The largest charts first, or the last thread ends long after the others.
std::vector<std::size_t> by_falling_size(const Atlas& atlas)
{
    std::vector<std::size_t> order(atlas.chart.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
        return atlas.chart[a].face.pixels.size() > atlas.chart[b].face.pixels.size();
    });
    return order;
}

std::vector<ChartTiles> judge_views(const Atlas& atlas, const BakeInput& input, const BakeTextureParams& params,
                                    Batches& batches)
{
    const auto order = by_falling_size(atlas);
    std::vector<std::optional<TileSamples>> samples(atlas.chart.size());
    std::vector<ChartTiles> tiles(atlas.chart.size());
    parallel_for(order.size(), [&](std::size_t i) {
        samples[order[i]].emplace(input.planes, atlas.chart[order[i]]);
        tiles[order[i]] = samples[order[i]]->empty_tiles();
    });
    batches.for_each("judging views", [&](const Batch& batch) {
        parallel_for(order.size(), [&](std::size_t i) {
            for (std::size_t b = 0; b < batch.view.size(); ++b)
                samples[order[i]]->judge(*batch.view[b], static_cast<std::uint32_t>(batch.first + b), tiles[order[i]]);
        });
    });
    parallel_for(order.size(), [&](std::size_t i) {
        if (params.last_views)
            keep_last_views_of_gaps(tiles[order[i]]);
        else
            tiles[order[i]].last_view.clear();
        rate_consistency(tiles[order[i]], params.consistency);
        choose_labels(tiles[order[i]], params.label_smoothness);
    });
    return tiles;
}

// The low band of a lattice, at texels.
class ShiftedBand {
public:
    ShiftedBand(LowBand band, const Eigen::Vector2i& first, int stride)
        : band_(std::move(band)), first_(first), scale_(1.0f / static_cast<float>(stride))
    {
    }
    Eigen::Vector3f at(const Eigen::Vector2f& texel) const
    {
        const Eigen::Vector2f place = (texel - first_.cast<float>()) * scale_;
        return band_.at(place.x(), place.y());
    }

private:
    LowBand band_;
    Eigen::Vector2i first_; // texel of the lattice's first point
    float scale_;
};

std::uint8_t luma(const WeightedColor& point)
{
    if (point.weight <= 0.0f) return 0;
    const float value = Eigen::Vector3f(0.299f, 0.587f, 0.114f).dot(point.color());
    return static_cast<std::uint8_t>(std::clamp(value + 0.5f, 1.0f, 255.0f));
}

LumaLattice luma(const Image<WeightedColor>& lattice)
{
    LumaLattice result(lattice.width, lattice.height);
    std::ranges::transform(lattice.pixels, result.pixels.begin(), [](const auto& point) { return luma(point); });
    return result;
}

LumaLattice part_of(const LumaLattice& lattice, const Eigen::Vector2i& first, const Eigen::Vector2i& size)
{
    LumaLattice result(size.x(), size.y());
    for (int y = 0; y < size.y(); ++y)
        std::copy_n(lattice.row(first.y() + y) + first.x(), size.x(), result.row(y));
    return result;
}

// The sums over views of one chart: those of all views on a lattice of every kStride-th texel, for they give coarse
// colours only, and then those of the best views at every texel.
class ChartBlend {
public:
    ChartBlend(const PlaneMesh& planes, const TexelChart& texels, const ChartTiles& tiles,
               const BakeTextureParams& params)
        : texels_(&texels), tiles_(&tiles), params_(&params), positions_(planes, texels),
          stride_(params.blend == Blend::Mean ? 1 : kStride),
          cell_(std::max(1, static_cast<int>(std::lround(params.band_width * texels.chart.density / stride_)))),
          mean_(on_lattice(texels.width()), on_lattice(texels.height())), last_views_(texels, tiles)
    {
        if (params.blend != Blend::Mean) best_ = Image<WeightedColor>(texels.width(), texels.height());
    }

    // All views one after the other, keyframes ascending, and then once more.
    void add_coarse(const TextureView& view, std::uint32_t keyframe);
    void add_detail(const TextureView& view, std::uint32_t keyframe);
    ChartColors finish() const;

private:
    struct Lattice { // a part of the chart's
        Eigen::Vector2i first_tile;
        Image<WeightedColor> color;
    };
    // What a view that lends detail has shown on the lattice.
    struct CoarseView {
        std::uint32_t keyframe = 0;
        Eigen::Vector2i first_tile = Eigen::Vector2i::Zero();
        LumaLattice luma;
        std::optional<ShiftedBand> low; // two-band only
    };
    int on_lattice(int texels) const { return (texels + stride_ - 1) / stride_; }
    Eigen::Vector2i end_of(const Eigen::Vector2i& tile) const // [texel]
    {
        return ((tile.array() + 1) * kTileSize).min(Eigen::Array2i(texels_->width(), texels_->height()));
    }
    Lattice sample(const TextureView& view, const TileWeights& weights);
    void sample_tile(const TextureView& view, const TileWeights& weights, const Eigen::Vector2i& tile,
                     Lattice& lattice);
    CoarseView coarse_view(std::uint32_t keyframe, const Lattice& lattice) const;
    ResidualShifts shifts(const CoarseView& coarse) const;
    void add_detail(const TextureView& view, const TileWeights& weights, const Eigen::Vector2i& tile,
                    const CoarseView& coarse, const ResidualShifts& shifts);

    const TexelChart* texels_;
    const ChartTiles* tiles_;
    const BakeTextureParams* params_;
    TexelPositions positions_;
    int stride_;                     // of the lattice [texel]
    int cell_;                       // [lattice step]
    Image<WeightedColor> mean_;      // of the lattice
    LumaLattice mean_luma_;          // once the mean is known
    Image<WeightedColor> best_;      // whole colours (best-view) or those above the low band (two-band)
    std::vector<CoarseView> coarse_; // keyframes ascending
    LastViews last_views_;
};

void ChartBlend::sample_tile(const TextureView& view, const TileWeights& weights, const Eigen::Vector2i& tile,
                             Lattice& lattice)
{
    const bool plain_mean = params_->blend == Blend::Mean;
    const double density = texels_->chart.density;
    const Eigen::Vector2i begin = tile * kTileSize, end = end_of(tile), origin = lattice.first_tile * kTileSize;
    for (int y = begin.y(); y < end.y(); y += stride_) {
        const TileWeights::Row consistency = weights.consistency(tile.x(), y);
        const RowAims aims(view, *texels_, positions_, {{begin.x(), y}, kTileSize, stride_}, Margins::Safe);
        for (int x = begin.x(); x < end.x(); x += stride_) {
            const auto sighting = view.see(aims[x], Margins::Safe);
            if (!sighting) continue;
            const Eigen::Vector3f recorded = view.recorded_color(*sighting, density);
            const Eigen::Vector3f color = view.common_color(*sighting, recorded);
            const double resolution = sighting->resolution / density;
            const double quality = sighting->trust * sighting->facing * resolution * resolution * view.sharpness();
            const float weight = plain_mean ? 1.0f
                                            : static_cast<float>(quality) *
                                                  consistency[static_cast<std::size_t>(x - begin.x())] *
                                                  TextureView::exposure_weight(recorded);
            if (weight > 0.0f) mean_.at(x / stride_, y / stride_).add(color, weight);
            lattice.color.at((x - origin.x()) / stride_, (y - origin.y()) / stride_).add(color, 1.0f);
        }
    }
}

// What the view shows of the chart, on the lattice; adds it to the mean.
ChartBlend::Lattice ChartBlend::sample(const TextureView& view, const TileWeights& weights)
{
    Eigen::AlignedBox2i reached;
    for (int row = 0; row < tiles_->rows; ++row)
        for (int column = 0; column < tiles_->columns; ++column)
            if (weights.reaches(column, row)) reached.extend(Eigen::Vector2i(column, row));
    const Eigen::Vector2i size = end_of(reached.max()) - reached.min() * kTileSize;
    Lattice lattice{reached.min(), Image<WeightedColor>(on_lattice(size.x()), on_lattice(size.y()))};
    for (int row = reached.min().y(); row <= reached.max().y(); ++row)
        for (int column = reached.min().x(); column <= reached.max().x(); ++column)
            if (weights.reaches(column, row)) sample_tile(view, weights, {column, row}, lattice);
    return lattice;
}

ChartBlend::CoarseView ChartBlend::coarse_view(std::uint32_t keyframe, const Lattice& lattice) const
{
    const auto& [first_tile, color] = lattice;
    CoarseView result{keyframe, first_tile, luma(color), {}};
    if (params_->blend == Blend::TwoBand) result.low.emplace(LowBand(color, cell_), first_tile * kTileSize, stride_);
    return result;
}

ResidualShifts ChartBlend::shifts(const CoarseView& coarse) const
{
    if (params_->residual_shift == 0.0) return {};
    const auto& [keyframe, first_tile, view, low] = coarse;
    return {view, part_of(mean_luma_, first_tile * kTileSize / stride_, {view.width, view.height}), stride_,
            params_->residual_shift};
}

void ChartBlend::add_detail(const TextureView& view, const TileWeights& weights, const Eigen::Vector2i& tile,
                            const CoarseView& coarse, const ResidualShifts& shifts)
{
    const Eigen::Vector2i begin = tile * kTileSize, end = end_of(tile);
    for (int y = begin.y(); y < end.y(); ++y) {
        const TileWeights::Row weight = weights.detail(tile.x(), y);
        int first = begin.x(), last = end.x();
        while (first < last && weight[static_cast<std::size_t>(first - begin.x())] <= 0.0f)
            ++first;
        while (first < last && weight[static_cast<std::size_t>(last - 1 - begin.x())] <= 0.0f)
            --last;
        const TexelRow row = shifts.shifted({{first, y}, last - first}, tile - coarse.first_tile);
        const RowAims aims(view, *texels_, positions_, row, Margins::Safe);
        for (int x = first; x < last; ++x) {
            const auto sighting = view.see(aims[x], Margins::Safe);
            if (!sighting) continue;
            Eigen::Vector3f color = view.common_color(*sighting, view.detail_color(*sighting, texels_->chart.density));
            if (coarse.low) color -= coarse.low->at(row.place(x));
            best_.at(x, y).add(color, weight[static_cast<std::size_t>(x - begin.x())]);
        }
    }
}

void ChartBlend::add_coarse(const TextureView& view, std::uint32_t keyframe)
{
    last_views_.add(view, keyframe, positions_);
    const TileWeights weights(*tiles_, keyframe, params_->detail_quality);
    if (!weights.any_view()) return;
    const Lattice lattice = sample(view, weights);
    if (!best_.empty() && weights.any_detail()) coarse_.push_back(coarse_view(keyframe, lattice));
}

void ChartBlend::add_detail(const TextureView& view, std::uint32_t keyframe)
{
    const auto coarse = std::ranges::lower_bound(coarse_, keyframe, {}, &CoarseView::keyframe);
    if (coarse == coarse_.end() || coarse->keyframe != keyframe) return;
    const TileWeights weights(*tiles_, keyframe, params_->detail_quality);
    if (mean_luma_.empty()) mean_luma_ = luma(mean_); // the mean of all views by now
    const ResidualShifts residual = shifts(*coarse);
    for (int row = 0; row < tiles_->rows; ++row)
        for (int column = 0; column < tiles_->columns; ++column)
            if (weights.gives_detail(column, row)) add_detail(view, weights, {column, row}, *coarse, residual);
    coarse->luma = {}; // done with
    coarse->low.reset();
}

ChartColors ChartBlend::finish() const
{
    ChartColors result{Image<Eigen::Vector3f>(texels_->width(), texels_->height(), Eigen::Vector3f::Zero()),
                       Image<TexelSource>(texels_->width(), texels_->height(), TexelSource::Empty)};
    std::optional<ShiftedBand> low;
    if (params_->blend == Blend::TwoBand) low.emplace(LowBand(mean_, cell_), Eigen::Vector2i::Zero(), stride_);
    for (int y = 0; y < result.color.height; ++y)
        for (int x = 0; x < result.color.width; ++x) {
            if (texels_->face.at(x, y) == kNoFace) continue;
            if (!best_.empty() && best_.at(x, y).weight > 0.0f) {
                result.color.at(x, y) = best_.at(x, y).color();
                if (low) result.color.at(x, y) += low->at(Eigen::Vector2i(x, y).cast<float>());
            } else if (const WeightedColor mean = between(mean_, stride_, x, y);
                       mean.weight == (x % stride_ ? 2.0f : 1.0f) * (y % stride_ ? 2.0f : 1.0f)) {
                // Where the labelled view misses a texel, the mean of the others stands in.
                result.color.at(x, y) = mean.color();
            } else {
                continue;
            }
            result.source.at(x, y) = TexelSource::Photograph;
        }
    last_views_.fill_gaps(result, params_->seam_step);
    return result;
}

} // namespace

std::vector<ChartColors> blend_views(const Atlas& atlas, const BakeInput& input, const BakeTextureParams& params)
{
    Batches batches(input, params);
    const auto tiles = judge_views(atlas, input, params, batches);
    const auto order = by_falling_size(atlas);
    std::vector<std::optional<ChartBlend>> blend(atlas.chart.size());
    parallel_for(order.size(), [&](std::size_t i) {
        blend[order[i]].emplace(input.planes, atlas.chart[order[i]], tiles[order[i]], params);
    });
    const auto gather = [&](const std::string& part, void (ChartBlend::*add)(const TextureView&, std::uint32_t)) {
        batches.for_each(part, [&](const Batch& batch) {
            parallel_for(order.size(), [&](std::size_t i) {
                for (std::size_t b = 0; b < batch.view.size(); ++b)
                    (*blend[order[i]].*add)(*batch.view[b], static_cast<std::uint32_t>(batch.first + b));
            });
        });
    };
    gather("gathering coarse colours", &ChartBlend::add_coarse);
    if (params.blend != Blend::Mean) gather("gathering detail", &ChartBlend::add_detail);
    std::vector<ChartColors> colors(atlas.chart.size());
    parallel_for(order.size(), [&](std::size_t i) {
        colors[order[i]] = blend[order[i]]->finish();
        blend[order[i]].reset();
    });
    return colors;
}

} // namespace quoin
