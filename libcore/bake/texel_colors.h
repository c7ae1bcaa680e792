// Colours of the texels of a chart, as sums over views while they are gathered and as colours afterwards.
#pragma once

#include "image/image.h"
#include "mesh/textured_mesh.h"

#include <Eigen/Core>
#include <algorithm>

namespace quoin {

// A colour times its weight (0..255 per unit of weight), and the weight; weight 0 = unknown.
struct WeightedColor {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    float weight = 0.0f;

    void add(const Eigen::Vector3f& color, float w)
    {
        sum += w * color;
        weight += w;
    }
    Eigen::Vector3f color() const { return sum / weight; }
};

// Colour at a texel, of a lattice of every `stride`-th texel: the mean of its points around that are known.
inline WeightedColor between(const Image<WeightedColor>& lattice, int stride, int x, int y)
{
    WeightedColor mean;
    for (int j = y / stride; j <= std::min((y + stride - 1) / stride, lattice.height - 1); ++j)
        for (int i = x / stride; i <= std::min((x + stride - 1) / stride, lattice.width - 1); ++i)
            if (const WeightedColor& point = lattice.at(i, j); point.weight > 0.0f) mean.add(point.color(), 1.0f);
    return mean;
}

// One per texel of the chart's rectangle.
struct ChartColors {
    Image<Eigen::Vector3f> color; // 0..255
    Image<TexelSource> source;    // Empty where the colour is not known
};

} // namespace quoin
