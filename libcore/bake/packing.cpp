#include "bake/packing.h"

#include "bake/occupancy.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>

namespace quoin {
namespace {

constexpr double kGuessedUse = 0.93; // of a page by masks, to guess its width
constexpr double kGoodUse = 0.85;    // that is not worth another width
constexpr int kWidths = 8;           // to try at most
constexpr double kWider = 1.03;      // one than the one before
constexpr double kNear = 0.25;       // how far below the highest place another is near it, in shorter sides of the mask
constexpr std::size_t kTurns = 4;

int round_up(int value, int multiple) { return (value + multiple - 1) / multiple * multiple; }

using Turns = std::vector<Shape>; // of one mask

Turns all_turns(const BitMask& mask)
{
    Turns turns;
    turns.emplace_back(mask);
    while (turns.size() < kTurns)
        turns.emplace_back(turned(turns.back().mask()));
    return turns;
}

struct Place {
    int contact = 0;
    int end = 0; // first row below the mask
    int x = 0, turns = 0;
    bool operator<(const Place& b) const // the better one
    {
        return std::tuple(-contact, end, x, turns) < std::tuple(-b.contact, b.end, b.x, b.turns);
    }
};

class Page {
public:
    Page(int width, int height) : taken_(width, height) {}

    std::optional<Place> find(const Turns& turns) const
    {
        const BitMask& unturned = turns[0].mask();
        const int near = static_cast<int>(kNear * std::min(unturned.width(), unturned.height()));
        int limit = taken_.height(); // of the ends that are worth a look
        std::array<int, kTurns> first{};
        for (std::size_t t = 0; t < kTurns; ++t) {
            first[t] = first_row(turns[t], limit);
            limit = std::min(limit, first[t] + turns[t].mask().height() + near);
        }
        std::optional<Place> best;
        for (std::size_t t = 0; t < kTurns; ++t)
            for (int y = first[t]; y + turns[t].mask().height() <= limit; ++y)
                look_at_row(turns[t], static_cast<int>(t), y, best);
        return best;
    }

    void put(const Turns& turns, const Place& place)
    {
        const BitMask& mask = turns[static_cast<std::size_t>(place.turns)].mask();
        taken_.take(mask, place.x, place.end - mask.height());
        used_.width = std::max(used_.width, place.x + mask.width());
        used_.height = std::max(used_.height, place.end);
    }

    PageSize used() const { return used_; }

private:
    // In which the shape fits somewhere, with its end at most at the limit; else the limit.
    int first_row(const Shape& shape, int limit) const
    {
        std::vector<std::uint64_t> fits;
        for (int y = 0; y + shape.mask().height() <= limit; ++y)
            if (taken_.find_places(shape, y, fits)) return y;
        return limit;
    }

    // Places at the ends of gaps touch more than those between.
    void look_at_row(const Shape& shape, int turn, int y, std::optional<Place>& best) const
    {
        std::vector<std::uint64_t> fits;
        if (!taken_.find_places(shape, y, fits)) return;
        for (std::size_t w = 0; w < fits.size(); ++w) {
            const std::uint64_t before = w > 0 ? fits[w - 1] >> (BitMask::kWordBits - 1) : 0;
            const std::uint64_t after = w + 1 < fits.size() ? fits[w + 1] << (BitMask::kWordBits - 1) : 0;
            const std::uint64_t between = (fits[w] << 1 | before) & (fits[w] >> 1 | after);
            for (std::uint64_t ends = fits[w] & ~between; ends != 0; ends &= ends - 1) {
                const int x = static_cast<int>(w) * BitMask::kWordBits + std::countr_zero(ends);
                const Place place{taken_.contact(shape, x, y), y + shape.mask().height(), x, turn};
                if (!best || place < *best) best = place;
            }
        }
    }

    Occupancy taken_;
    PageSize used_;
};

std::vector<std::size_t> largest_first(const std::vector<BitMask>& masks)
{
    std::vector<std::size_t> order(masks.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto area = [&](std::size_t i) { return std::int64_t{masks[i].width()} * masks[i].height(); };
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return area(a) > area(b); });
    return order;
}

double total_area(const std::vector<BitMask>& masks)
{
    double area = 0.0;
    for (const auto& mask : masks)
        area += static_cast<double>(count(mask));
    return area;
}

int page_width(const std::vector<BitMask>& masks, double area, int max_side, int multiple)
{
    int longest = 1;
    for (const auto& mask : masks)
        longest = std::max({longest, mask.width(), mask.height()});
    const int side = static_cast<int>(std::ceil(std::sqrt(area / kGuessedUse)));
    return std::min(max_side, round_up(std::max(side, longest), multiple));
}

struct PlaceOnPage {
    std::size_t page;
    Place place;
};

// The first page with room for a mask; a new one, of the given size, if none has.
PlaceOnPage find_page(std::vector<Page>& pages, const Turns& turns, PageSize size)
{
    for (std::size_t p = 0; p < pages.size(); ++p)
        if (const auto place = pages[p].find(turns)) return {p, *place};
    pages.emplace_back(size.width, size.height);
    return {pages.size() - 1, pages.back().find(turns).value()};
}

Packing pack_on_width(const std::vector<BitMask>& masks, int width, int max_side, int multiple)
{
    Packing packing;
    packing.mask.resize(masks.size());
    std::vector<Page> pages;
    for (const auto i : largest_first(masks)) {
        const auto turns = all_turns(masks[i]);
        const auto [page, place] = find_page(pages, turns, {width, max_side});
        pages[page].put(turns, place);
        const int height = turns[static_cast<std::size_t>(place.turns)].mask().height();
        packing.mask[i] = {static_cast<std::uint32_t>(page), place.x, place.end - height, place.turns};
    }
    for (const auto& page : pages)
        packing.page.push_back({round_up(page.used().width, multiple), round_up(page.used().height, multiple)});
    return packing;
}

} // namespace

double area_of(const std::vector<PageSize>& pages)
{
    double area = 0.0;
    for (const auto& page : pages)
        area += static_cast<double>(page.width) * page.height;
    return area;
}

Packing pack_masks(const std::vector<BitMask>& masks, int max_side, int multiple)
{
    const double area = total_area(masks);
    int width = page_width(masks, area, max_side, multiple);
    Packing best = pack_on_width(masks, width, max_side, multiple);
    for (int i = 1; i < kWidths && width < max_side && area < kGoodUse * area_of(best.page); ++i) {
        width = std::min(max_side, round_up(static_cast<int>(std::ceil(kWider * width)), multiple));
        Packing packing = pack_on_width(masks, width, max_side, multiple);
        if (area_of(packing.page) < area_of(best.page)) best = std::move(packing);
    }
    return best;
}

} // namespace quoin
