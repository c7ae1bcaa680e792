// Which lines along a strip the most of its places see an edge on.
#pragma once

#include "lines/edge_points.h"

#include <span>
#include <utility>
#include <vector>

namespace quoin {

// d(i) = offset + slope i across the strip, for place i [px].
struct StripLine {
    double offset = 0.0, slope = 0.0;
    double at(double place) const { return offset + slope * place; }
};

// Votes of one polarity's edge points for whole offsets -reach..reach. Each place has one vote for a line, however
// strong its edge: the strongest edges near a crease are patterns and shadows as often as the crease.
class EdgeVotes {
public:
    EdgeVotes(std::span<const EdgePoint> points, int places, const DetectLinesParams& params);

    // Of the line parallel to the strip's.
    double at_offset(double offset) const;

    // The line with most votes and its votes; each px between its middle and `expected` costs it the fraction
    // `off_cost` of them. All lines of whole offsets are tried whose rise is even and at most `max_rise` px.
    std::pair<StripLine, double> best(int max_rise, double expected, double off_cost) const;

private:
    int stride() const { return 6 * reach_ + 1; }
    double slope_of(int rise) const; // of a line that rises so many px from the first to the last place
    // Votes of all lines of that slope: element k is of the one that starts at offset k - reach.
    std::vector<float> sums(int rise) const;

    int reach_, places_;
    std::vector<float> vote_; // one row a place, with room for a rise of 2 reach on either side
    std::vector<float> parallel_;
};

} // namespace quoin
