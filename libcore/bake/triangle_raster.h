// Which texels of a chart a triangle touches.
#pragma once

#include "bake/charts.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace quoin {

using Triangle2 = std::array<Eigen::Vector2d, 3>; // [texel], texel centres at integers

// A face in texels of its chart; the chart's first texel reaches from its corner (0, 0) to 1/density.
inline Triangle2 chart_triangle(const TriangleMesh& mesh, const Chart& chart, FaceId f)
{
    Triangle2 triangle;
    for (int k = 0; k < 3; ++k)
        triangle[static_cast<std::size_t>(k)] =
            chart.from_world(corner(mesh, f, k)) * chart.density - Eigen::Vector2d::Constant(0.5);
    return triangle;
}

inline double squared_distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b)
{
    const Eigen::Vector2d ab = b - a;
    const double length2 = ab.squaredNorm();
    const double t = length2 > 0.0 ? std::clamp(ab.dot(p - a) / length2, 0.0, 1.0) : 0.0;
    return (p - a - t * ab).squaredNorm();
}

// A point this near to an edge is on it, whatever rounding says [texel].
inline constexpr double kOnEdge = 1e-9;

// Distance of p to the triangle [texel]; 0 strictly inside, at least kOnEdge on an edge: two faces that share an edge
// never both contain a texel centre on it.
inline double distance_to_triangle(const Eigen::Vector2d& p, const Triangle2& t)
{
    const auto side = [&](std::size_t i, std::size_t j) {
        return (t[j].x() - t[i].x()) * (p.y() - t[i].y()) - (t[j].y() - t[i].y()) * (p.x() - t[i].x());
    };
    const double a = side(0, 1), b = side(1, 2), c = side(2, 0);
    if (std::min({a, b, c}) > kOnEdge || std::max({a, b, c}) < -kOnEdge) return 0.0;
    return std::max(kOnEdge, std::sqrt(std::min({squared_distance_to_segment(p, t[0], t[1]),
                                                 squared_distance_to_segment(p, t[1], t[2]),
                                                 squared_distance_to_segment(p, t[2], t[0])})));
}

struct Span {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    void extend(double value)
    {
        low = std::min(low, value);
        high = std::max(high, value);
    }
};

// The part of the x axis that the triangle spans between y - reach and y + reach.
inline Span span_of_rows(const Triangle2& triangle, double y, double reach)
{
    Span span;
    for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::Vector2d &a = triangle[i], &b = triangle[(i + 1) % 3];
        const double low = std::max(std::min(a.y(), b.y()), y - reach),
                     high = std::min(std::max(a.y(), b.y()), y + reach);
        if (low > high) continue;
        if (a.y() == b.y()) {
            span.extend(a.x());
            span.extend(b.x());
        } else {
            const double slope = (b.x() - a.x()) / (b.y() - a.y());
            span.extend(a.x() + (low - a.y()) * slope);
            span.extend(a.x() + (high - a.y()) * slope);
        }
    }
    return span;
}

// Calls visit(x, y, distance) for the texels of a width x height grid whose centres are inside the triangle (distance
// 0) or at most `reach` texels away from it, row by row.
template <class Visit>
void for_each_texel(const Triangle2& triangle, int width, int height, double reach, const Visit& visit)
{
    constexpr double kRounding = 1e-6; // [texel], of the spans
    const auto [low, high] = std::minmax({triangle[0].y(), triangle[1].y(), triangle[2].y()});
    const int y0 = std::max(0, static_cast<int>(std::ceil(low - reach)));
    const int y1 = std::min(height - 1, static_cast<int>(std::floor(high + reach)));
    for (int y = y0; y <= y1; ++y) {
        const auto span = span_of_rows(triangle, y, reach + kRounding);
        const int x0 = std::max(0, static_cast<int>(std::ceil(span.low - reach - kRounding)));
        const int x1 = std::min(width - 1, static_cast<int>(std::floor(span.high + reach + kRounding)));
        for (int x = x0; x <= x1; ++x) {
            const double distance = distance_to_triangle(Eigen::Vector2d(x, y), triangle);
            if (distance <= reach) visit(x, y, distance);
        }
    }
}

} // namespace quoin
