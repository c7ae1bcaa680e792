#include "synth/creases.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

using Eigen::Vector3d;

constexpr double kOnLine = 1e-6;       // [m]
constexpr double kParallel = 1e-3;     // sine of the least angle between planes that meet
constexpr double kLeastLength = 0.002; // [m]

// A stretch of a line; side +1 where the surface lies to the left of the direction, seen from its free side.
struct Stretch {
    double from, to;
    int side;
};

// Borders of a surface on the line through `foot` along `direction`: edges that two pieces share cancel out.
std::vector<Stretch> borders_on_line(const PlanarSurface& surface, const Vector3d& foot, const Vector3d& direction)
{
    struct Change {
        double at;
        int by;
    };
    std::vector<Change> changes;
    const auto off_line = [&](const Vector3d& p) { return ((p - foot) - direction * direction.dot(p - foot)).norm(); };
    for (const Polygon& piece : surface.pieces)
        for (std::size_t i = 0; i < piece.size(); ++i) {
            const Vector3d &a = piece[i], &b = piece[(i + 1) % piece.size()];
            if (off_line(a) > kOnLine || off_line(b) > kOnLine) continue;
            const double ta = direction.dot(a - foot), tb = direction.dot(b - foot);
            const int side = tb > ta ? 1 : -1;
            changes.push_back({std::min(ta, tb), side});
            changes.push_back({std::max(ta, tb), -side});
        }
    std::sort(changes.begin(), changes.end(),
              [](const Change& a, const Change& b) { return a.at != b.at ? a.at < b.at : a.by < b.by; });
    std::vector<Stretch> stretches;
    int side = 0;
    for (std::size_t i = 0; i + 1 < changes.size(); ++i) {
        side += changes[i].by;
        if (side != 0 && changes[i + 1].at - changes[i].at > kOnLine)
            stretches.push_back({changes[i].at, changes[i + 1].at, side > 0 ? 1 : -1});
    }
    return stretches;
}

// Where the borders of two surfaces lie on each other; neighbouring stretches of equal sides become one.
struct Meeting {
    double from, to;
    int side_a, side_b;
};
std::vector<Meeting> meetings(const std::vector<Stretch>& a, const std::vector<Stretch>& b)
{
    std::vector<Meeting> found;
    for (const Stretch& s : a)
        for (const Stretch& t : b) {
            const double from = std::max(s.from, t.from), to = std::min(s.to, t.to);
            if (to - from > kOnLine) found.push_back({from, to, s.side, t.side});
        }
    std::sort(found.begin(), found.end(), [](const Meeting& x, const Meeting& y) { return x.from < y.from; });
    std::vector<Meeting> joined;
    for (const Meeting& m : found) {
        const bool goes_on = !joined.empty() && m.from - joined.back().to < kOnLine &&
                             m.side_a == joined.back().side_a && m.side_b == joined.back().side_b;
        if (goes_on)
            joined.back().to = std::max(joined.back().to, m.to);
        else
            joined.push_back(m);
    }
    std::erase_if(joined, [](const Meeting& m) { return m.to - m.from < kLeastLength; });
    return joined;
}

// The point of two planes' line that is nearest to the origin.
Vector3d foot_of_line(const Plane& a, const Plane& b, const Vector3d& direction)
{
    Eigen::Matrix3d rows;
    rows << a.normal.transpose(), b.normal.transpose(), direction.transpose();
    return rows.inverse() * Vector3d(-a.offset, -b.offset, 0.0);
}

struct Bounds {
    Vector3d low, high;
};
Bounds bounds_of(const PlanarSurface& surface)
{
    Bounds bounds{surface.pieces[0][0], surface.pieces[0][0]};
    for (const Polygon& piece : surface.pieces)
        for (const Vector3d& p : piece) {
            bounds.low = bounds.low.cwiseMin(p);
            bounds.high = bounds.high.cwiseMax(p);
        }
    return bounds;
}

} // namespace

std::vector<RoomCrease> find_creases(const Room& room)
{
    std::vector<Bounds> bounds;
    for (const PlanarSurface& surface : room.planar)
        bounds.push_back(bounds_of(surface));
    std::vector<RoomCrease> creases;
    for (PlaneId a = 0; a < room.planar.size(); ++a)
        for (PlaneId b = a + 1; b < room.planar.size(); ++b) {
            if ((bounds[a].low.array() - kOnLine > bounds[b].high.array()).any() ||
                (bounds[b].low.array() - kOnLine > bounds[a].high.array()).any())
                continue;
            const PlanarSurface &sa = room.planar[a], &sb = room.planar[b];
            const Vector3d cross = sa.plane.normal.cross(sb.plane.normal);
            if (cross.norm() < kParallel) continue;
            const Vector3d direction = cross.normalized(), foot = foot_of_line(sa.plane, sb.plane, direction);
            for (const Meeting& m :
                 meetings(borders_on_line(sa, foot, direction), borders_on_line(sb, foot, direction)))
                creases.push_back(
                    {{foot + m.from * direction, foot + m.to * direction},
                     {a, b},
                     {m.side_a * sa.plane.normal.cross(direction), m.side_b * sb.plane.normal.cross(direction)}});
        }
    return creases;
}

} // namespace quoin
