// Coarse colours of an image with holes: means over cells, smoothed and interpolated, ignoring what is unknown.
#pragma once

#include "bake/texel_colors.h"

namespace quoin {

class LowBand {
public:
    // cell [texel]: the standard deviation of the low-pass. Every known texel counts alike.
    LowBand(const Image<WeightedColor>& texels, int cell);
    // The coarse colour at a texel; zero where nothing is known within two cells.
    Eigen::Vector3f at(int x, int y) const;

private:
    void smooth();

    int cell_;
    Image<WeightedColor> cells_;
};

} // namespace quoin
