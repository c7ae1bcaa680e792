// Colours of the texels of a chart, as sums over views while they are gathered and as colours afterwards.
#pragma once

#include "image/image.h"
#include "mesh/textured_mesh.h"

#include <Eigen/Core>

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

// One per texel of the chart's rectangle.
struct ChartColors {
    Image<Eigen::Vector3f> color; // 0..255
    Image<TexelSource> source;    // Empty where the colour is not known
};

} // namespace quoin
