#include "bake/packing.h"
#include "image/image.h"

#include <gmock/gmock.h>

#include <random>

namespace quoin {
namespace {

std::vector<RectangleSize> random_rectangles(std::size_t count, int longest)
{
    std::mt19937 random(7);
    std::vector<RectangleSize> sizes;
    for (std::size_t i = 0; i < count; ++i) {
        const auto side = [&] { return 1 + static_cast<int>(random() % static_cast<unsigned>(longest)); };
        sizes.push_back({side(), side()});
    }
    return sizes;
}

// Marks every rectangle's pixels; fails where two meet or one leaves its page. Returns the used part of all pages.
double expect_disjoint(const std::vector<RectangleSize>& sizes, const Packing& packing)
{
    std::vector<Image<char>> pages;
    double area = 0.0, used = 0.0;
    for (const auto& page : packing.page) {
        pages.emplace_back(page.width, page.height, 0);
        area += static_cast<double>(page.width) * page.height;
    }
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        const auto& place = packing.rectangle[i];
        const int width = place.turned ? sizes[i].height : sizes[i].width,
                  height = place.turned ? sizes[i].width : sizes[i].height;
        auto& page = pages[place.page];
        EXPECT_TRUE(place.x >= 0 && place.y >= 0 && place.x + width <= page.width && place.y + height <= page.height);
        int met = 0;
        for (int y = place.y; y < place.y + height; ++y)
            for (int x = place.x; x < place.x + width; ++x)
                met += page.at(x, y)++;
        EXPECT_EQ(met, 0) << "rectangle " << i;
        used += static_cast<double>(width) * height;
    }
    return area > 0.0 ? used / area : 1.0;
}

TEST(Packing, NeverOverlapsAndWastesLittle)
{
    const auto sizes = random_rectangles(400, 120);
    const auto packing = pack_rectangles(sizes, 4096);
    EXPECT_EQ(packing.page.size(), 1u);
    EXPECT_GT(expect_disjoint(sizes, packing), 0.85);
}

TEST(Packing, TakesMorePagesWhenOneIsTooSmall)
{
    const auto sizes = random_rectangles(200, 120);
    const auto packing = pack_rectangles(sizes, 256);
    EXPECT_GT(packing.page.size(), 5u);
    EXPECT_GT(expect_disjoint(sizes, packing), 0.75);
}

TEST(Packing, TurnsARectangleThatFitsNoOtherWay)
{
    const std::vector<RectangleSize> sizes{{64, 8}, {56, 64}, {8, 56}};
    const auto packing = pack_rectangles(sizes, 72);
    expect_disjoint(sizes, packing);
    EXPECT_EQ(packing.page.size(), 1u);
}

TEST(Packing, HasPageSidesThatAreMultiplesOfFour)
{
    for (const auto& page : pack_rectangles({{13, 7}, {5, 9}}, 1024).page) {
        EXPECT_EQ(page.width % 4, 0);
        EXPECT_EQ(page.height % 4, 0);
    }
}

TEST(Packing, FillsAPageExactly)
{
    const auto packing = pack_rectangles({{256, 256}}, 256);
    ASSERT_EQ(packing.page.size(), 1u);
    EXPECT_EQ(packing.page[0].width, 256);
    EXPECT_EQ(packing.page[0].height, 256);
}

TEST(Packing, OfNothingHasNoPage) { EXPECT_TRUE(pack_rectangles({}, 256).page.empty()); }

} // namespace
} // namespace quoin
