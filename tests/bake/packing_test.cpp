#include "bake/packing.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numeric>
#include <random>

namespace quoin {
namespace {

BitMask rectangle(int width, int height)
{
    BitMask mask(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            mask.set(x, y);
    return mask;
}

// A rectangle without its inside.
BitMask frame(int width, int height, int thickness)
{
    BitMask mask(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            if (std::min({x, y, width - 1 - x, height - 1 - y}) < thickness) mask.set(x, y);
    return mask;
}

// Unions of discs and bars in all directions, with bays, holes and loose parts.
std::vector<BitMask> random_masks(std::size_t count, int longest)
{
    std::mt19937 random(7);
    std::vector<BitMask> masks;
    for (std::size_t i = 0; i < count; ++i) {
        const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
        BitMask mask(1 + below(longest), 1 + below(longest));
        for (int part = 0; part < 3; ++part) {
            const double cx = below(mask.width()), cy = below(mask.height()), angle = 0.01 * below(314);
            const double length = 1 + below(longest / 2), thickness = 1 + below(1 + longest / 8);
            for (int y = 0; y < mask.height(); ++y)
                for (int x = 0; x < mask.width(); ++x) {
                    const double along = std::cos(angle) * (x - cx) + std::sin(angle) * (y - cy),
                                 across = std::cos(angle) * (y - cy) - std::sin(angle) * (x - cx);
                    if (std::abs(along) <= length && std::abs(across) <= thickness) mask.set(x, y);
                }
        }
        masks.push_back(std::move(mask));
    }
    return masks;
}

// Paints every mask onto its page; fails where two meet or one leaves its page.
void expect_disjoint(const std::vector<BitMask>& masks, const Packing& packing)
{
    std::vector<BitMask> pages;
    for (const auto& page : packing.page)
        pages.emplace_back(page.width, page.height);
    for (std::size_t i = 0; i < masks.size(); ++i) {
        const auto& place = packing.mask[i];
        BitMask mask = masks[i];
        for (int turn = 0; turn < place.turns; ++turn)
            mask = turned(mask);
        auto& page = pages[place.page];
        int met = 0;
        for (int y = 0; y < mask.height(); ++y)
            for (int x = 0; x < mask.width(); ++x) {
                if (!mask.test(x, y)) continue;
                const int px = place.x + x, py = place.y + y;
                if (px < 0 || py < 0 || px >= page.width() || py >= page.height()) {
                    ADD_FAILURE() << "mask " << i << " leaves its page";
                    return;
                }
                met += page.test(px, py);
                page.set(px, py);
            }
        EXPECT_EQ(met, 0) << "mask " << i;
    }
}

std::int64_t area_of_pages(const Packing& packing)
{
    return std::accumulate(packing.page.begin(), packing.page.end(), std::int64_t{0},
                           [](std::int64_t sum, const PageSize& page) { return sum + page.width * page.height; });
}

// What the best packing of rectangles would need.
std::int64_t area_of_rectangles(const std::vector<BitMask>& masks)
{
    return std::accumulate(masks.begin(), masks.end(), std::int64_t{0},
                           [](std::int64_t sum, const BitMask& mask) { return sum + mask.width() * mask.height(); });
}

TEST(BitMask, TurnsClockwise)
{
    BitMask mask(70, 3);
    mask.set(0, 2);
    mask.set(69, 0);
    const BitMask once = turned(mask);
    EXPECT_EQ(once.width(), 3);
    EXPECT_EQ(once.height(), 70);
    EXPECT_TRUE(once.test(0, 0)) << "the bottom left corner becomes the top left one";
    EXPECT_TRUE(once.test(2, 69)) << "the top right corner becomes the bottom right one";
    EXPECT_EQ(count(once), 2u);
}

TEST(Packing, NeverOverlapsAndNeedsLessThanRectanglesWould)
{
    for (const int longest : {7, 40, 150}) {
        const auto masks = random_masks(300, longest);
        const auto packing = pack_masks(masks, 4096, 4);
        EXPECT_EQ(packing.page.size(), 1u);
        expect_disjoint(masks, packing);
        EXPECT_LT(area_of_pages(packing), area_of_rectangles(masks)) << "masks up to " << longest;
    }
}

TEST(Packing, TakesMorePagesWhenOneIsTooSmall)
{
    const auto masks = random_masks(200, 120);
    const auto packing = pack_masks(masks, 256, 4);
    EXPECT_GT(packing.page.size(), 4u);
    expect_disjoint(masks, packing);
    EXPECT_LT(area_of_pages(packing), area_of_rectangles(masks));
    for (const auto& page : packing.page)
        EXPECT_LE(std::max(page.width, page.height), 256);
}

TEST(Packing, FillsHolesOfLargeMasks)
{
    const std::vector<BitMask> masks{frame(60, 60, 20), rectangle(20, 20), frame(100, 100, 20)};
    const auto packing = pack_masks(masks, 1024, 4);
    expect_disjoint(masks, packing);
    ASSERT_EQ(packing.page.size(), 1u);
    EXPECT_EQ(packing.page[0].width, 100) << "one in the other";
    EXPECT_EQ(packing.page[0].height, 100);
}

TEST(Packing, TurnsAMaskThatFitsNoOtherWay)
{
    const std::vector<BitMask> masks{rectangle(64, 8), rectangle(56, 64), rectangle(8, 56)};
    const auto packing = pack_masks(masks, 72, 4);
    expect_disjoint(masks, packing);
    EXPECT_EQ(packing.page.size(), 1u);
}

TEST(Packing, HasPageSidesThatAreMultiples)
{
    for (const auto& page : pack_masks({rectangle(13, 7), rectangle(5, 9)}, 1024, 4).page) {
        EXPECT_EQ(page.width % 4, 0);
        EXPECT_EQ(page.height % 4, 0);
    }
}

TEST(Packing, FillsAPageExactly)
{
    const auto packing = pack_masks({rectangle(256, 256)}, 256, 4);
    ASSERT_EQ(packing.page.size(), 1u);
    EXPECT_EQ(packing.page[0].width, 256);
    EXPECT_EQ(packing.page[0].height, 256);
}

TEST(Packing, OfNothingHasNoPage) { EXPECT_TRUE(pack_masks({}, 256, 4).page.empty()); }

} // namespace
} // namespace quoin
