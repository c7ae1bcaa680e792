#include "lines/follow_stretches.h"

#include "geometry/units.h"
#include "lines/edge_votes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <tuple>

namespace quoin {
namespace {

struct Run {
    int first = 0, last = -1; // places
    int size() const { return last - first + 1; }
};

// Of every place of the run the point nearest to the line, if one lies within `tolerance`.
std::vector<EdgePoint> inliers(std::span<const EdgePoint> points, const StripLine& line, const Run& run,
                               double tolerance)
{
    std::vector<EdgePoint> near;
    for (const EdgePoint& point : points) {
        if (point.place < run.first || point.place > run.last) continue;
        const double distance = std::abs(point.offset - line.at(point.place));
        if (distance > tolerance) continue;
        if (near.empty() || near.back().place != point.place)
            near.push_back(point);
        else if (distance < std::abs(near.back().offset - line.at(point.place)))
            near.back() = point;
    }
    return near;
}

// Least squares, Tukey's weights about the line before: distances near `tolerance` count for nothing.
StripLine fit(std::span<const EdgePoint> points, const StripLine& before, double tolerance)
{
    double w = 0.0, x = 0.0, d = 0.0, xx = 0.0, xd = 0.0;
    for (const EdgePoint& point : points) {
        const double r = (point.offset - before.at(point.place)) / tolerance;
        const double weight = std::pow(1.0 - r * r, 2);
        w += weight;
        x += weight * point.place;
        d += weight * point.offset;
        xx += weight * point.place * point.place;
        xd += weight * point.place * point.offset;
    }
    const double determinant = w * xx - x * x;
    if (!(determinant > 1e-9 * w * xx)) return before;
    const double slope = (w * xd - x * d) / determinant;
    return {(d - slope * x) / w, slope};
}

// Iterated fits, the tolerance closing in on its final value.
StripLine refine(std::span<const EdgePoint> points, StripLine line, const Run& run, double tolerance)
{
    for (const double factor : {2.0, 1.5, 1.0, 1.0, 1.0})
        line = fit(inliers(points, line, run, factor * tolerance), line, factor * tolerance);
    return line;
}

// The run of places in which the share of those with an inlier exceeds `share` by most places.
Run densest_run(std::span<const EdgePoint> on_line, double share)
{
    Run best, current;
    double gain = 0.0, best_gain = 0.0;
    int before = -1;
    for (const EdgePoint& point : on_line) {
        gain -= share * (point.place - before - 1);
        if (gain <= 0.0) {
            gain = 0.0;
            current.first = point.place;
        }
        gain += 1.0 - share;
        current.last = before = point.place;
        if (gain > best_gain) {
            best_gain = gain;
            best = current;
        }
    }
    return best;
}

// Logarithm of a bound (Hoeffding) on the chance that at least k of n independent places have a point on a line when
// each has one with probability p.
double log_tail(double k, double n, double p)
{
    const double share = k / n;
    if (share <= p) return 0.0;
    const double rest = share < 1.0 ? (1.0 - share) * std::log((1.0 - share) / (1.0 - p)) : 0.0;
    return -n * (share * std::log(share / p) + rest);
}

// Decimal logarithm of the number of false alarms: how many lines as good as this one the strip would show by chance,
// with as many points thrown in anywhere (Desolneux et al. 2000).
double log_false_alarms(std::size_t on_line, const Run& run, std::size_t points, const Strip& strip,
                        const DetectLinesParams& params)
{
    constexpr double kPixelsShared = 2.0; // neighbouring places are smoothed into each other
    const double width = 2.0 * params.guided_reach + 1.0;
    const double per_px = static_cast<double>(points) / (strip.places * width);
    const double p = std::min(1.0, 2.0 * params.guided_tolerance * per_px);
    const double tests = 2.0 * width * width * strip.places * strip.places; // polarities, lines, runs
    return (std::log(tests) + log_tail(static_cast<double>(on_line) / kPixelsShared, run.size() / kPixelsShared, p)) /
           std::numbers::ln10;
}

// A stretch and the edges beside it, by polarity.
struct Search {
    std::size_t stretch;
    Strip strip;
    std::array<std::vector<EdgePoint>, 2> points;
    std::array<EdgeVotes, 2> votes;
};

Search search_beside(const GrayImage& image, const Stretch& stretch, std::size_t index, const DetectLinesParams& params)
{
    const Strip strip = strip_between(stretch.pixel[0], stretch.pixel[1], params);
    std::array<std::vector<EdgePoint>, 2> points;
    for (const EdgePoint& point : edge_points(image, strip, params))
        points[point.gradient > 0.0f ? 0 : 1].push_back(point);
    return {
        index, strip, points, {EdgeVotes(points[0], strip.places, params), EdgeVotes(points[1], strip.places, params)}};
}

// By how much the whole image lies beside the borders [px]: a wrong pose moves all of them nearly alike. The shift with
// which most places see an edge, whatever its polarity.
Eigen::Vector2d common_shift(const std::vector<Search>& searches, const DetectLinesParams& params)
{
    Eigen::Vector2d best = Eigen::Vector2d::Zero();
    double most = 0.0;
    for (int y = -params.guided_reach; y <= params.guided_reach; ++y)
        for (int x = -params.guided_reach; x <= params.guided_reach; ++x) {
            const Eigen::Vector2d shift(x, y);
            double votes = 0.0;
            for (const Search& search : searches) {
                const double offset = search.strip.across.dot(shift);
                votes += std::max(search.votes[0].at_offset(offset), search.votes[1].at_offset(offset));
            }
            votes *= 1.0 - params.guided_off_cost * shift.norm() / (std::numbers::sqrt2 * params.guided_reach);
            if (votes > most) {
                most = votes;
                best = shift;
            }
        }
    return best;
}

// Of the edges in one image.
struct Expectation {
    Eigen::Vector2d shift; // to where the borders appear [px]
    double min_length;     // [px]
};

struct Edge {
    Segment segment;
    double votes;
};

std::optional<Edge> edge_of_polarity(const Search& search, std::size_t polarity, const Expectation& expected,
                                     const DetectLinesParams& params)
{
    const Strip& strip = search.strip;
    const auto& points = search.points[polarity];
    if (static_cast<double>(points.size()) * strip.step < params.guided_share * expected.min_length) return {};
    const double length = strip.step * (strip.places - 1);
    const int max_rise =
        std::min(2 * params.guided_reach, static_cast<int>(length * std::tan(radians(params.match_angle))));
    auto [line, votes] = search.votes[polarity].best(max_rise, strip.across.dot(expected.shift),
                                                     params.guided_off_cost / params.guided_reach);
    if (votes <= 0.0) return {};
    const Run whole{0, strip.places - 1};
    line = refine(points, line, whole, params.guided_tolerance);
    const Run run = densest_run(inliers(points, line, whole, params.guided_tolerance), params.guided_share);
    if ((run.size() - 1) * strip.step < expected.min_length) return {};
    line = refine(points, line, run, params.guided_tolerance);
    const auto on_line = inliers(points, line, run, params.guided_tolerance);
    if (static_cast<double>(on_line.size()) < params.guided_share * run.size() ||
        log_false_alarms(on_line.size(), run, points.size(), strip, params) > params.guided_log_alarms)
        return {};
    const auto pixel = [&, line = line](int place) -> Eigen::Vector2d {
        return strip.start + place * strip.step * strip.along + line.at(place) * strip.across;
    };
    return Edge{{pixel(run.first), pixel(run.last)}, votes};
}

struct Found {
    std::size_t stretch;
    Segment segment;
    Overlap overlap;
    double off; // mean distance to where the shift puts the border [px]
    auto key() const { return std::tuple(off, stretch); }
};

std::optional<Found> find_edge(const Search& search, const Stretch& stretch, const Expectation& expected,
                               const MeshView& view, const DetectLinesParams& params)
{
    const auto up = edge_of_polarity(search, 0, expected, params);
    const auto down = edge_of_polarity(search, 1, expected, params);
    if (!up && !down) return {};
    const Segment segment = !down || (up && up->votes >= down->votes) ? up->segment : down->segment;
    const auto overlap = overlap_of(segment, stretch, view.camera, params);
    if (!overlap) return {};
    const Strip& strip = search.strip;
    const auto off = [&](const Eigen::Vector2d& u) {
        return std::abs(strip.across.dot(u - strip.start - expected.shift));
    };
    return Found{search.stretch, segment, *overlap, 0.5 * (off(segment.a) + off(segment.b))};
}

// Do two segments show the same edge? Their lines then run within the tolerance of each other where both are.
bool same_edge(const Segment& x, const Segment& y, double tolerance)
{
    const Eigen::Vector2d along = (x.b - x.a).normalized(), across(-along.y(), along.x());
    const std::pair<double, double> extent = std::minmax(along.dot(y.a - x.a), along.dot(y.b - x.a));
    if (std::min(x.length(), extent.second) <= std::max(0.0, extent.first)) return false;
    return std::abs(across.dot(y.a - x.a)) <= tolerance && std::abs(across.dot(y.b - x.a)) <= tolerance;
}

// Nearest first; each edge once.
std::vector<Found> choose(std::vector<Found> found, double tolerance)
{
    std::ranges::sort(found, {}, &Found::key);
    std::vector<Found> chosen;
    for (const Found& candidate : found)
        if (std::ranges::none_of(
                chosen, [&](const Found& other) { return same_edge(other.segment, candidate.segment, tolerance); }))
            chosen.push_back(candidate);
    std::ranges::sort(chosen, {}, &Found::stretch);
    return chosen;
}

} // namespace

std::vector<SegmentMatch> follow_stretches(const GrayImage& image, const std::vector<Stretch>& stretches,
                                           const MeshView& view, const DetectLinesParams& params)
{
    const double min_length = min_segment_length(image, params);
    std::vector<Search> searches;
    for (std::size_t i = 0; i < stretches.size(); ++i)
        if ((stretches[i].pixel[1] - stretches[i].pixel[0]).norm() >= min_length)
            searches.push_back(search_beside(image, stretches[i], i, params));
    const Expectation expected{common_shift(searches, params), min_length};
    std::vector<Found> found;
    for (const Search& search : searches)
        if (const auto edge = find_edge(search, stretches[search.stretch], expected, view, params))
            found.push_back(*edge);
    std::vector<SegmentMatch> matches;
    for (const Found& one : choose(std::move(found), 2.0 * params.guided_tolerance))
        matches.push_back(matched(one.segment, stretches[one.stretch], one.overlap, view));
    return matches;
}

} // namespace quoin
