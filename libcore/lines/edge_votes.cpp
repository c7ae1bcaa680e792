#include "lines/edge_votes.h"

#include <algorithm>
#include <cmath>

namespace quoin {

EdgeVotes::EdgeVotes(std::span<const EdgePoint> points, int places, const DetectLinesParams& params)
    : reach_(params.guided_reach), places_(places),
      vote_(static_cast<std::size_t>(places) * static_cast<std::size_t>(width()), 0.0f),
      parallel_(static_cast<std::size_t>(width()))
{
    const auto spread = static_cast<float>(params.guided_tolerance + 0.5);
    for (const EdgePoint& point : points) {
        float* row = vote_.data() + static_cast<std::ptrdiff_t>(point.place) * width();
        const int first = std::max(-reach_, static_cast<int>(std::ceil(point.offset - spread)));
        const int last = std::min(reach_, static_cast<int>(std::floor(point.offset + spread)));
        for (int d = first; d <= last; ++d)
            row[d + reach_] = std::max(row[d + reach_], 1.0f - std::abs(static_cast<float>(d) - point.offset) / spread);
    }
    add_up(0, parallel_);
}

double EdgeVotes::at_offset(double offset) const
{
    const auto d = std::lround(offset);
    return std::abs(d) <= reach_ ? parallel_[static_cast<std::size_t>(d + reach_)] : 0.0;
}

std::pair<StripLine, double> EdgeVotes::best(int max_rise, double expected, double off_cost) const
{
    std::pair<StripLine, double> best{{}, 0.0};
    std::vector<float> sum(static_cast<std::size_t>(width()));
    for (int rise = -max_rise; rise <= max_rise; ++rise) {
        add_up(rise, sum);
        for (int d = -reach_; d <= reach_; ++d) {
            const double off = std::abs(d + 0.5 * rise - expected);
            const double votes = sum[static_cast<std::size_t>(d + reach_)] * (1.0 - off_cost * off);
            if (votes > best.second) best = {{static_cast<double>(d), slope_of(rise)}, votes};
        }
    }
    return best;
}

double EdgeVotes::slope_of(int rise) const { return static_cast<double>(rise) / std::max(1, places_ - 1); }

// Of all lines of one slope, side by side: sum[k] is of the line that starts at offset k - reach.
void EdgeVotes::add_up(int rise, std::vector<float>& sum) const
{
    std::ranges::fill(sum, 0.0f);
    for (int i = 0; i < places_; ++i) {
        const int shift = static_cast<int>(std::lround(slope_of(rise) * i));
        const int first = std::max(0, -shift), last = std::min(width(), width() - shift);
        const float* vote = row(i) + shift;
        for (int k = first; k < last; ++k)
            sum[static_cast<std::size_t>(k)] += vote[k];
    }
}

} // namespace quoin
