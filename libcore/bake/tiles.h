// Which views see which part of a chart, how well, and which of them is to show it: decided per tile of texels.
#pragma once

#include "bake/atlas.h"
#include "bake/texture_view.h"

#include <array>
#include <vector>

namespace quoin {

inline constexpr int kTileSize = 16; // [texel]
inline constexpr std::uint32_t kNoView = 0xffffffffu;

struct TileView {
    std::uint32_t keyframe = 0;
    float quality = 0.0f; // 0..1: resolution, angle, sharpness, centring, trust and the part of the tile that is seen
    float consistency = 1.0f;                        // 0..1: agreement of its colour with the other views'
    Eigen::Vector3f color = Eigen::Vector3f::Zero(); // mean over the tile's samples, common exposure
    float worth() const { return quality * consistency; }
};

using SampleSet = std::uint16_t; // a bit for each sample of a tile

struct ChartTiles {
    int columns = 0, rows = 0;
    std::vector<std::vector<TileView>> view;           // of every tile, row by row; keyframes ascending
    std::vector<std::uint32_t> label;                  // keyframe that shows the tile; kNoView where none sees it
    std::vector<SampleSet> unseen;                     // samples of every tile that no view sees by the safe margins
    std::vector<std::vector<std::uint32_t>> last_view; // of every tile: keyframes that see some of it by the least
                                                       // margins, ascending
    std::size_t index(int column, int row) const
    {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
    }
};

// Points of a chart's tiles at which views are judged.
class TileSamples {
public:
    TileSamples(const PlaneMesh& planes, const TexelChart& texels);
    // Adds to `tiles` how the view sees each tile.
    void judge(const TextureView& view, std::uint32_t keyframe, ChartTiles& tiles) const;
    ChartTiles empty_tiles() const;

private:
    struct Sample {
        Eigen::Vector3d p_world, normal_world;
    };
    struct Judgement {
        TileView view;
        SampleSet seen = 0;            // by the safe margins
        bool by_least_margins = false; // is any sample seen by these?
    };
    Judgement judge_tile(const TextureView& view, std::size_t tile) const;

    int columns_, rows_;
    double density_;
    std::vector<std::vector<Sample>> sample_;          // of every tile
    Eigen::Vector3d centre_ = Eigen::Vector3d::Zero(); // of a ball around all samples
    double radius_ = 0.0;
};

// Every `stride`-th of `count` texels, at most those of a tile; looked at `shift` beside the first one and
// `shift_step` further beside each next texel [texel].
struct TexelRow {
    Eigen::Vector2i first;
    int count = kTileSize, stride = 1;
    Eigen::Vector2f shift = Eigen::Vector2f::Zero(), shift_step = Eigen::Vector2f::Zero();

    Eigen::Vector2f place(int texel_x) const
    {
        const int steps = texel_x - first.x();
        return Eigen::Vector2i(texel_x, first.y()).cast<float>() + shift + static_cast<float>(steps) * shift_step;
    }
};

// A view's aims at a row of texels; outside the chart it sees nothing.
class RowAims {
public:
    RowAims(const TextureView& view, const TexelChart& texels, const TexelPositions& positions, const TexelRow& row,
            Margins margins);
    const TextureView::Aim& operator[](int texel_x) const
    {
        return aim_[static_cast<std::size_t>((texel_x - row_.first.x()) / row_.stride)];
    }

private:
    TexelRow row_;
    std::array<TextureView::Aim, kTileSize> aim_;
};

// Leaves last views only to tiles that have unseen samples.
void keep_last_views_of_gaps(ChartTiles& tiles);

// Lowers the consistency of views whose colour on a tile is far from the median of all views' (`deviation` in grey
// levels is one standard deviation).
void rate_consistency(ChartTiles& tiles, double deviation);

// Labels every tile with a view: minimises the sum over tiles of -log(quality * consistency) plus `smoothness` for each
// pair of neighbouring tiles with different views, by iterated conditional modes.
void choose_labels(ChartTiles& tiles, double smoothness);

// Weights of one view between the centres of tiles, bilinear. Detail comes from the labelled view and, the less the
// worse they are, from others with at least `detail_quality` of its quality and consistency.
class TileWeights {
public:
    TileWeights(const ChartTiles& tiles, std::uint32_t keyframe, double detail_quality);
    bool any_view() const { return any_view_; }
    bool any_detail() const { return any_detail_; }
    // Is the view's weight positive anywhere in the tile?
    bool reaches(int column, int row) const { return is_positive_near(consistency_, column, row); }
    bool gives_detail(int column, int row) const { return is_positive_near(detail_, column, row); }
    // Of the texels of a tile in one row of texels.
    using Row = std::array<float, kTileSize>;
    Row consistency(int column, int texel_y) const { return row(consistency_, column, texel_y); }
    // 0..1, sharpened so that tiles mix over a quarter of their width only; 0 where others outweigh it by far.
    Row detail(int column, int texel_y) const;

private:
    Row row(const std::vector<float>& weight, int column, int texel_y) const;
    bool is_positive_near(const std::vector<float>& weight, int column, int row) const;
    std::size_t index(int column, int row) const
    {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
    }

    int columns_, rows_;
    std::vector<float> consistency_; // of every tile
    std::vector<float> detail_;      // fourth root of the weight in the middle of the tile
    bool any_view_ = false, any_detail_ = false;
};

} // namespace quoin
