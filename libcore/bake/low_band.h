// Coarse colours of an image with holes: means over cells, smoothed and interpolated, ignoring what is unknown. Where
// the known texels lie to one side, as at the end of what a view sees, their mean is carried on along its slope.
#pragma once

#include "bake/texel_colors.h"

namespace quoin {

class LowBand {
public:
    // cell [texel]: the standard deviation of the low-pass. Every known texel counts alike.
    LowBand(const Image<WeightedColor>& texels, int cell);
    // The coarse colour at a texel or between texels; zero where nothing is known within two cells.
    Eigen::Vector3f at(float x, float y) const;

private:
    // The known texels about a cell: their mean colour and place [texel], and how the colour changes from place to
    // place.
    struct Cell {
        WeightedColor color;
        Eigen::Vector2f place = Eigen::Vector2f::Zero(); // times the weight
    };
    // colour * weight = at_origin + slope * place, and the weight, as
    // they are mixed for every texel.
    struct Ramp {
        Eigen::Matrix<float, 3, 2> slope = Eigen::Matrix<float, 3, 2>::Zero();
        Eigen::Vector3f at_origin = Eigen::Vector3f::Zero();
        float weight = 0.0f;
    };
    void smooth(Image<Cell>& cells) const;
    void find_ramps(Image<Cell> cells);

    int cell_;
    Image<Ramp> ramps_;
};

} // namespace quoin
