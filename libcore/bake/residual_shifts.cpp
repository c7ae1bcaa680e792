#include "bake/residual_shifts.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace quoin {
namespace {

using Eigen::Vector2f;

constexpr float kNoise = 8.0f;             // standard deviation of the views' differences [grey levels]
constexpr float kSpread = 0.4f;            // of shifts, before anything is known [texel]
constexpr float kLeastPoints = 4.0f;       // of a tile, or its change of brightness explains all
constexpr float kNeighbours = 1.0f / 2.0f; // weight of a tile's neighbours to either side against its own
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

// A s = b, the normal equations of a shift s.
struct NormalEquations {
    Eigen::Matrix2f A = Eigen::Matrix2f::Zero();
    Vector2f b = Vector2f::Zero();

    void add(const NormalEquations& other, float weight)
    {
        A += weight * other.A;
        b += weight * other.b;
    }
};

// (1 2 1) / 4 both ways, or points that lie two texels apart alias. Unknown where any of the nine is.
Image<float> smoothed(const LumaLattice& lattice)
{
    Image<float> rows(lattice.width, lattice.height, kUnknown), result = rows;
    const auto value = [&](int x, int y) {
        return lattice.at(x, y) == 0 ? kUnknown : static_cast<float>(lattice.at(x, y));
    };
    for (int y = 0; y < lattice.height; ++y)
        for (int x = 1; x + 1 < lattice.width; ++x)
            rows.at(x, y) = 0.25f * (value(x - 1, y) + 2.0f * value(x, y) + value(x + 1, y));
    for (int y = 1; y + 1 < lattice.height; ++y)
        for (int x = 0; x < lattice.width; ++x)
            result.at(x, y) = 0.25f * (rows.at(x, y - 1) + 2.0f * rows.at(x, y) + rows.at(x, y + 1));
    return result;
}

// Of the points [begin, end), in lattice steps; the mean difference is a change of brightness and taken off.
NormalEquations equations_of_tile(const Image<float>& view, const Image<float>& mean, const Eigen::Vector2i& begin,
                                  const Eigen::Vector2i& end)
{
    NormalEquations sum;
    Vector2f gradients = Vector2f::Zero();
    float differences = 0.0f, count = 0.0f;
    for (int y = std::max(1, begin.y()); y < std::min(end.y(), view.height - 1); ++y)
        for (int x = std::max(1, begin.x()); x < std::min(end.x(), view.width - 1); ++x) {
            const auto slope = [&](const Image<float>& image) {
                return Vector2f(image.at(x + 1, y) - image.at(x - 1, y), image.at(x, y + 1) - image.at(x, y - 1));
            };
            const Vector2f gradient = 0.25f * (slope(view) + slope(mean));
            const float difference = mean.at(x, y) - view.at(x, y);
            if (!gradient.allFinite() || !std::isfinite(difference)) continue;
            sum.A += gradient * gradient.transpose();
            sum.b += gradient * difference;
            gradients += gradient;
            differences += difference;
            count += 1.0f;
        }
    if (count < kLeastPoints) return {};
    sum.A -= gradients * gradients.transpose() / count;
    sum.b -= gradients * differences / count;
    return sum;
}

Image<NormalEquations> with_neighbours(Image<NormalEquations> tiles)
{
    for (const Eigen::Vector2i& step : {Eigen::Vector2i(1, 0), Eigen::Vector2i(0, 1)}) {
        Image<NormalEquations> result = tiles;
        for (int y = 0; y < tiles.height; ++y)
            for (int x = 0; x < tiles.width; ++x)
                for (const int side : {-1, 1})
                    if (const Eigen::Vector2i at = Eigen::Vector2i(x, y) + side * step; tiles.contains(at.x(), at.y()))
                        result.at(x, y).add(tiles.at(at.x(), at.y()), kNeighbours);
        tiles = std::move(result);
    }
    return tiles;
}

} // namespace

ResidualShifts::ResidualShifts(const LumaLattice& view, const LumaLattice& mean, int stride, double limit)
{
    const int points = kTileSize / stride; // along a tile
    const Image<float> smooth_view = smoothed(view), smooth_mean = smoothed(mean);
    Image<NormalEquations> tiles((view.width + points - 1) / points, (view.height + points - 1) / points);
    for (int row = 0; row < tiles.height; ++row)
        for (int column = 0; column < tiles.width; ++column) {
            const Eigen::Vector2i begin = points * Eigen::Vector2i(column, row);
            tiles.at(column, row) =
                equations_of_tile(smooth_view, smooth_mean, begin, begin + Eigen::Vector2i::Constant(points));
        }
    tiles = with_neighbours(std::move(tiles));
    const auto step = static_cast<float>(stride), longest = static_cast<float>(limit);
    const Eigen::Matrix2f stiffness = std::pow(step * kNoise / kSpread, 2.0f) * Eigen::Matrix2f::Identity();
    shift_ = Image<Vector2f>(tiles.width, tiles.height, Vector2f::Zero());
    for (std::size_t i = 0; i < tiles.pixels.size(); ++i) {
        const Vector2f shift = step * (tiles.pixels[i].A + stiffness).inverse() * tiles.pixels[i].b;
        shift_.pixels[i] = shift * std::min(1.0f, longest / std::max(longest, shift.norm()));
    }
}

Eigen::Vector2f ResidualShifts::at_corner(int column, int row) const
{
    const auto at = [&](int c, int r) {
        return shift_.at(std::clamp(c, 0, shift_.width - 1), std::clamp(r, 0, shift_.height - 1));
    };
    return 0.25f * (at(column - 1, row - 1) + at(column, row - 1) + at(column - 1, row) + at(column, row));
}

// Bilinear between the corners of tiles, so along a row it is linear.
TexelRow ResidualShifts::shifted(TexelRow texels, const Eigen::Vector2i& tile) const
{
    if (shift_.empty()) return texels;
    const Vector2f part =
        ((texels.first - (texels.first / kTileSize) * kTileSize).cast<float>().array() + 0.5f) / kTileSize;
    const auto at_side = [&](int column) -> Vector2f {
        return (1.0f - part.y()) * at_corner(column, tile.y()) + part.y() * at_corner(column, tile.y() + 1);
    };
    const Vector2f left = at_side(tile.x()), across = at_side(tile.x() + 1) - left;
    texels.shift = left + part.x() * across;
    texels.shift_step = across / kTileSize;
    return texels;
}

} // namespace quoin
