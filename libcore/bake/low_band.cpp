#include "bake/low_band.h"

#include <algorithm>
#include <array>

namespace quoin {

LowBand::LowBand(const Image<WeightedColor>& texels, int cell)
    : cell_(cell), ramps_((texels.width + cell - 1) / cell, (texels.height + cell - 1) / cell)
{
    Image<Cell> cells(ramps_.width, ramps_.height);
    for (int y = 0; y < texels.height; ++y)
        for (int x = 0; x < texels.width; ++x)
            if (const auto& texel = texels.at(x, y); texel.weight > 0.0f) {
                Cell& c = cells.at(x / cell, y / cell);
                c.color.add(texel.color(), 1.0f);
                c.place += Eigen::Vector2i(x, y).cast<float>();
            }
    smooth(cells);
    find_ramps(std::move(cells));
}

void LowBand::smooth(Image<Cell>& cells) const
{
    constexpr std::array<float, 5> kBinomial{1.0f / 16, 4.0f / 16, 6.0f / 16, 4.0f / 16, 1.0f / 16};
    const auto pass = [&](int dx, int dy) {
        Image<Cell> result(cells.width, cells.height);
        for (int y = 0; y < cells.height; ++y)
            for (int x = 0; x < cells.width; ++x)
                for (int k = -2; k <= 2; ++k) {
                    const int nx = x + k * dx, ny = y + k * dy;
                    if (!cells.contains(nx, ny)) continue;
                    const float w = kBinomial.at(static_cast<std::size_t>(k) + 2);
                    result.at(x, y).color.sum += w * cells.at(nx, ny).color.sum;
                    result.at(x, y).color.weight += w * cells.at(nx, ny).color.weight;
                    result.at(x, y).place += w * cells.at(nx, ny).place;
                }
        cells = std::move(result);
    };
    pass(1, 0);
    pass(0, 1);
}

// Least squares over the cells around. Where their places hardly differ along some direction the slope there stays 0.
void LowBand::find_ramps(Image<Cell> cells)
{
    for (auto& cell : cells.pixels)
        if (cell.color.weight > 0.0f) {
            cell.color.sum /= cell.color.weight;
            cell.place /= cell.color.weight;
        }
    const float stiffness = static_cast<float>(cell_ * cell_) / 4.0f;
    for (int y = 0; y < cells.height; ++y)
        for (int x = 0; x < cells.width; ++x) {
            const Cell& cell = cells.at(x, y);
            if (cell.color.weight <= 0.0f) continue;
            Eigen::Matrix2f places = stiffness * Eigen::Matrix2f::Identity();
            Eigen::Matrix<float, 3, 2> colors = Eigen::Matrix<float, 3, 2>::Zero();
            for (int j = std::max(0, y - 1); j <= std::min(cells.height - 1, y + 1); ++j)
                for (int i = std::max(0, x - 1); i <= std::min(cells.width - 1, x + 1); ++i) {
                    const Cell& other = cells.at(i, j);
                    if (other.color.weight <= 0.0f) continue;
                    const Eigen::Vector2f step = other.place - cell.place;
                    places += step * step.transpose();
                    colors += (other.color.sum - cell.color.sum) * step.transpose();
                }
            const Eigen::Matrix<float, 3, 2> slope = colors * places.inverse();
            const float weight = cell.color.weight;
            ramps_.at(x, y) = {weight * slope, weight * (cell.color.sum - slope * cell.place), weight};
        }
}

Eigen::Vector3f LowBand::at(float x, float y) const
{
    const auto cell = static_cast<float>(cell_);
    const float cx = std::clamp((x + 0.5f) / cell - 0.5f, 0.0f, static_cast<float>(ramps_.width - 1));
    const float cy = std::clamp((y + 0.5f) / cell - 0.5f, 0.0f, static_cast<float>(ramps_.height - 1));
    const int x0 = static_cast<int>(cx), y0 = static_cast<int>(cy);
    const int x1 = std::min(x0 + 1, ramps_.width - 1), y1 = std::min(y0 + 1, ramps_.height - 1);
    const float fx = cx - static_cast<float>(x0), fy = cy - static_cast<float>(y0);
    Ramp mix;
    const auto add = [&](int i, int j, float w) {
        const Ramp& ramp = ramps_.at(i, j);
        mix.slope += w * ramp.slope;
        mix.at_origin += w * ramp.at_origin;
        mix.weight += w * ramp.weight;
    };
    add(x0, y0, (1 - fx) * (1 - fy));
    add(x1, y0, fx * (1 - fy));
    add(x0, y1, (1 - fx) * fy);
    add(x1, y1, fx * fy);
    if (mix.weight <= 0.0f) return Eigen::Vector3f::Zero();
    return (mix.at_origin + mix.slope.col(0) * x + mix.slope.col(1) * y) / mix.weight;
}

} // namespace quoin
