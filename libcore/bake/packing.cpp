#include "bake/packing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>

namespace quoin {
namespace {

constexpr int kPageMultiple = 4;     // block size of compressed textures
constexpr double kGuessedUse = 0.95; // of a page, when its size is first guessed
constexpr double kPageGrowth = 1.03; // from one guess to the next

int round_up(int value) { return (value + kPageMultiple - 1) / kPageMultiple * kPageMultiple; }

// The upper outline of what a page holds: steps from left to right, each at its height.
class Skyline {
public:
    Skyline(int width, int height) : width_(width), height_(height), steps_{{0, 0}} {}

    struct Spot {
        int top = std::numeric_limits<int>::max(); // height of the rectangle's far side
        int wasted = 0;                            // pixels shut in below it
        int x = 0, y = 0;
        bool turned = false;
        bool operator<(const Spot& b) const
        {
            return std::tie(top, wasted, x, turned) < std::tie(b.top, b.wasted, b.x, b.turned);
        }
    };

    std::optional<Spot> find(const RectangleSize& size) const
    {
        std::optional<Spot> best;
        const auto consider = [&](int w, int h, bool turned) {
            for (std::size_t i = 0; i < steps_.size() && steps_[i].x + w <= width_; ++i)
                if (auto spot = at(i, w, h)) {
                    spot->turned = turned;
                    if (!best || *spot < *best) best = spot;
                }
        };
        consider(size.width, size.height, false);
        if (size.width != size.height) consider(size.height, size.width, true);
        return best;
    }

    void place(const Spot& spot, const RectangleSize& size)
    {
        const int right = spot.x + (spot.turned ? size.height : size.width);
        std::vector<Step> steps;
        int height_at_right = 0;
        for (const auto& step : steps_) {
            if (step.x <= right) height_at_right = step.y;
            if (step.x < spot.x) steps.push_back(step);
        }
        steps.push_back({spot.x, spot.top});
        if (right < width_) steps.push_back({right, height_at_right});
        for (const auto& step : steps_)
            if (step.x > right) steps.push_back(step);
        steps_ = std::move(steps);
        used_height_ = std::max(used_height_, spot.top);
    }

    int used_height() const { return used_height_; }

private:
    struct Step {
        int x, y;
    };

    // The rectangle with its left side on step i.
    std::optional<Spot> at(std::size_t i, int w, int h) const
    {
        const int right = steps_[i].x + w;
        int y = 0;
        for (std::size_t j = i; j < steps_.size() && steps_[j].x < right; ++j)
            y = std::max(y, steps_[j].y);
        if (y + h > height_) return std::nullopt;
        int wasted = 0;
        for (std::size_t j = i; j < steps_.size() && steps_[j].x < right; ++j) {
            const int end = j + 1 < steps_.size() ? std::min(steps_[j + 1].x, right) : right;
            wasted += (end - steps_[j].x) * (y - steps_[j].y);
        }
        return Spot{y + h, wasted, steps_[i].x, y, false};
    }

    int width_, height_;
    int used_height_ = 0;
    std::vector<Step> steps_;
};

std::vector<std::size_t> longest_first(const std::vector<RectangleSize>& sizes)
{
    std::vector<std::size_t> order(sizes.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
        const auto key = [&](std::size_t i) {
            return std::pair(std::max(sizes[i].width, sizes[i].height), std::min(sizes[i].width, sizes[i].height));
        };
        return key(a) > key(b);
    });
    return order;
}

// Everything on pages of width x height; nullopt when more than max_pages would be needed.
std::optional<Packing> pack_into(const std::vector<RectangleSize>& sizes, RectangleSize page, std::size_t max_pages)
{
    Packing packing;
    packing.rectangle.resize(sizes.size());
    std::vector<Skyline> skylines;
    for (const auto i : longest_first(sizes)) {
        std::optional<Skyline::Spot> spot;
        std::size_t p = 0;
        for (; p < skylines.size() && !spot; ++p)
            spot = skylines[p].find(sizes[i]);
        if (!spot) {
            if (skylines.size() == max_pages) return std::nullopt;
            skylines.emplace_back(page.width, page.height);
            spot = skylines.back().find(sizes[i]);
            if (!spot) return std::nullopt;
            p = skylines.size();
        }
        skylines[p - 1].place(*spot, sizes[i]);
        packing.rectangle[i] = {static_cast<std::uint32_t>(p - 1), spot->x, spot->y, spot->turned};
    }
    for (const auto& skyline : skylines)
        packing.page.push_back({page.width, round_up(skyline.used_height())});
    return packing;
}

} // namespace

Packing pack_rectangles(const std::vector<RectangleSize>& sizes, int max_page)
{
    double area = 0.0;
    int longest = kPageMultiple;
    for (const auto& size : sizes) {
        area += static_cast<double>(size.width) * size.height;
        longest = std::max({longest, size.width, size.height});
    }
    double side = std::max<double>(longest, std::sqrt(area / kGuessedUse));
    for (; round_up(static_cast<int>(std::ceil(side))) < max_page; side *= kPageGrowth) {
        const int width = round_up(static_cast<int>(std::ceil(side)));
        if (auto packing = pack_into(sizes, {width, width}, 1)) return *packing;
    }
    return *pack_into(sizes, {max_page, max_page}, std::numeric_limits<std::size_t>::max());
}

} // namespace quoin
