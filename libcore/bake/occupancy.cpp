#include "bake/occupancy.h"

#include <algorithm>
#include <bit>

namespace quoin {
namespace {

constexpr std::uint64_t kAll = ~std::uint64_t{0};

// a &= not the bits of the row from `first` on.
void remove_bits(std::vector<std::uint64_t>& a, const std::uint64_t* row, int first)
{
    const std::uint64_t* word = row + first / BitMask::kWordBits;
    const int shift = first % BitMask::kWordBits;
    if (shift == 0)
        for (std::size_t i = 0; i < a.size(); ++i)
            a[i] &= ~word[i];
    else
        for (std::size_t i = 0; i < a.size(); ++i)
            a[i] &= ~(word[i] >> shift | word[i + 1] << (BitMask::kWordBits - shift));
}

int longest_gap(const std::uint64_t* row, int width)
{
    int longest = 0, gap = 0;
    for (int x = 0; x < width;) {
        const std::uint64_t word = row[x / BitMask::kWordBits] >> (x % BitMask::kWordBits);
        const int free = word == 0 ? BitMask::kWordBits - x % BitMask::kWordBits : std::countr_zero(word);
        gap += std::min(free, width - x);
        longest = std::max(longest, gap);
        x += free;
        if (word == 0) continue;
        gap = 0;
        x += std::countr_one(word >> free);
    }
    return longest;
}

std::vector<Shape::Run> runs_of(const BitMask& mask)
{
    std::vector<Shape::Run> runs;
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x) {
            if (!mask.test(x, y)) continue;
            const int first = x;
            while (x < mask.width() && mask.test(x, y))
                ++x;
            runs.push_back({y, first, x - first});
        }
    std::ranges::stable_sort(runs, [](const auto& a, const auto& b) { return a.length > b.length; });
    return runs;
}

BitMask rim_of(const BitMask& mask)
{
    const auto inside = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < mask.width() && y < mask.height() && mask.test(x, y);
    };
    BitMask rim(mask.width() + 2, mask.height() + 2);
    for (int y = -1; y <= mask.height(); ++y)
        for (int x = -1; x <= mask.width(); ++x)
            if (!inside(x, y) && (inside(x - 1, y) || inside(x + 1, y) || inside(x, y - 1) || inside(x, y + 1)))
                rim.set(x + 1, y + 1);
    return rim;
}

} // namespace

Shape::Shape(BitMask mask) : mask_(std::move(mask)), rim_(rim_of(mask_)), runs_(runs_of(mask_)) {}

Occupancy::Occupancy(int width, int height)
    : width_(width), height_(height), longest_gap_(static_cast<std::size_t>(height + 2), 0)
{
    for (int reach = 1; reach <= width; reach *= 2)
        reach_.emplace_back(width + 2, height + 2);
    for (int x = 0; x < width + 2; ++x)
        reach_[0].set(x, 0);
    for (int y = 0; y < height + 2; ++y) {
        reach_[0].set(0, y);
        reach_[0].set(width + 1, y);
        update_row(y);
    }
}

void Occupancy::update_row(int row)
{
    longest_gap_[static_cast<std::size_t>(row)] = longest_gap(reach_[0].row(row), width_ + 2);
    for (std::size_t k = 1; k < reach_.size(); ++k) {
        const int half = 1 << (k - 1);
        const std::uint64_t* from = reach_[k - 1].row(row);
        for (int w = 0; w * BitMask::kWordBits < width_ + 2; ++w)
            reach_[k].row(row)[w] =
                from[w] |
                (w * BitMask::kWordBits + half < width_ + 2 ? bits_from(from, w * BitMask::kWordBits + half) : 0);
    }
}

void Occupancy::take(const BitMask& mask, int x, int y)
{
    for (int r = 0; r < mask.height(); ++r) {
        std::uint64_t* word = reach_[0].row(y + r + 1) + (x + 1) / BitMask::kWordBits;
        const int shift = (x + 1) % BitMask::kWordBits;
        for (int w = 0; w * BitMask::kWordBits < mask.width(); ++w) {
            word[w] |= mask.row(r)[w] << shift;
            if (shift > 0) word[w + 1] |= mask.row(r)[w] >> (BitMask::kWordBits - shift);
        }
        update_row(y + r + 1);
    }
}

bool Occupancy::find_places(const Shape& shape, int y, std::vector<std::uint64_t>& fits) const
{
    const int places = width_ - shape.mask().width() + 1;
    const auto gap_is_too_short = [&](const Shape::Run& run) {
        const int row = y + run.row + 1;
        return longest_gap_[static_cast<std::size_t>(row)] < run.length;
    };
    if (places <= 0 || std::ranges::any_of(shape.runs(), gap_is_too_short)) return false;
    fits.assign(static_cast<std::size_t>((places + BitMask::kWordBits - 1) / BitMask::kWordBits), kAll);
    if (places % BitMask::kWordBits != 0) fits.back() = kAll >> (BitMask::kWordBits - places % BitMask::kWordBits);
    for (const auto& run : shape.runs()) {
        const unsigned half = std::bit_floor(static_cast<unsigned>(run.length)); // or more of the run
        const std::uint64_t* row = reach_[static_cast<std::size_t>(std::countr_zero(half))].row(y + run.row + 1);
        remove_bits(fits, row, run.first + 1);
        remove_bits(fits, row, run.first + 1 + run.length - static_cast<int>(half));
        if (std::ranges::all_of(fits, [](std::uint64_t word) { return word == 0; })) return false;
    }
    return true;
}

int Occupancy::contact(const Shape& shape, int x, int y) const
{
    const BitMask& rim = shape.rim();
    int cells = 0;
    for (int r = 0; r < rim.height(); ++r)
        for (int w = 0; w * BitMask::kWordBits < rim.width(); ++w)
            cells += std::popcount(rim.row(r)[w] & bits_from(reach_[0].row(y + r), x + w * BitMask::kWordBits));
    return cells;
}

} // namespace quoin
