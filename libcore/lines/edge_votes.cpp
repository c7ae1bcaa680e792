#include "lines/edge_votes.h"

#include <algorithm>
#include <cmath>

namespace quoin {

EdgeVotes::EdgeVotes(std::span<const EdgePoint> points, int places, const DetectLinesParams& params)
    : reach_(params.guided_reach), places_(places),
      vote_(static_cast<std::size_t>(places) * static_cast<std::size_t>(stride()), 0.0f)
{
    const auto spread = static_cast<float>(params.guided_tolerance + 0.5);
    for (const EdgePoint& point : points) {
        float* centre = vote_.data() + static_cast<std::ptrdiff_t>(point.place) * stride() + 3 * reach_;
        const int first = std::max(-reach_, static_cast<int>(std::ceil(point.offset - spread)));
        const int last = std::min(reach_, static_cast<int>(std::floor(point.offset + spread)));
        for (int d = first; d <= last; ++d)
            centre[d] = std::max(centre[d], 1.0f - std::abs(static_cast<float>(d) - point.offset) / spread);
    }
    parallel_ = sums(0);
}

double EdgeVotes::at_offset(double offset) const
{
    const int d = static_cast<int>(std::floor(offset + 0.5));
    return std::abs(d) <= reach_ ? parallel_[static_cast<std::size_t>(d + reach_)] : 0.0;
}

std::pair<StripLine, double> EdgeVotes::best(int max_rise, double expected, double off_cost) const
{
    std::pair<StripLine, double> best{{}, 0.0};
    const int steepest = std::min(max_rise, 2 * reach_) / 2 * 2; // each vote is wide enough for every other rise
    for (int rise = -steepest; rise <= steepest; rise += 2) {
        const auto sum = sums(rise);
        for (int d = -reach_; d <= reach_; ++d) {
            const double off = std::abs(d + 0.5 * rise - expected);
            const double votes = sum[static_cast<std::size_t>(d + reach_)] * (1.0 - off_cost * off);
            if (votes > best.second) best = {{static_cast<double>(d), slope_of(rise)}, votes};
        }
    }
    return best;
}

double EdgeVotes::slope_of(int rise) const { return static_cast<double>(rise) / std::max(1, places_ - 1); }

std::vector<float> EdgeVotes::sums(int rise) const
{
    std::vector<float> sum(static_cast<std::size_t>(2 * reach_ + 1), 0.0f);
    const double slope = slope_of(rise);
    for (int i = 0; i < places_; ++i) {
        const auto shift = static_cast<std::ptrdiff_t>(std::floor(slope * i + 0.5));
        const float* vote = vote_.data() + static_cast<std::ptrdiff_t>(i) * stride() + 2 * reach_ + shift;
        for (std::size_t k = 0; k < sum.size(); ++k)
            sum[k] += vote[k];
    }
    return sum;
}

} // namespace quoin
