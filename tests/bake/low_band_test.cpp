#include "bake/low_band.h"

#include <gtest/gtest.h>

namespace quoin {
namespace {

Eigen::Vector3f ramp(int x, int y)
{
    const auto u = static_cast<float>(x), v = static_cast<float>(y);
    return {100 + u, 200 - 2 * v, 50 + 0.5f * u + 0.5f * v};
}

TEST(LowBand, CarriesARampOnToWhereKnowledgeEnds)
{
    Image<WeightedColor> texels(64, 48);
    for (int y = 0; y < texels.height; ++y)
        for (int x = 0; x < texels.width; ++x)
            if (x + y < 60) texels.at(x, y).add(ramp(x, y), 0.3f);
    const LowBand low(texels, 6); // the mean of what is known would lie some 5 texels, 11 grey levels, inside
    for (int y = 0; y < texels.height; ++y)
        for (int x = 0; x + y < 60 && x < texels.width; ++x)
            EXPECT_LT((low.at(x, y) - ramp(x, y)).norm(), 5.5f) << x << " " << y;
}

TEST(LowBand, KeepsOneColourAndIsBlackWhereNothingIsKnown)
{
    Image<WeightedColor> texels(80, 8);
    const Eigen::Vector3f grey(90, 100, 110);
    texels.at(3, 3).add(grey, 2.0f);
    const LowBand low(texels, 4);
    EXPECT_LT((low.at(3, 3) - grey).norm(), 1e-3f);
    EXPECT_LT((low.at(0, 7) - grey).norm(), 1e-3f);
    EXPECT_EQ(low.at(79, 0), Eigen::Vector3f(0, 0, 0));
}

} // namespace
} // namespace quoin
