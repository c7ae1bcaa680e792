#include "bake/charts.h"

#include "bake/triangle_raster.h"
#include "mesh/adjacency.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <set>

namespace quoin {
namespace {

// Flood fill over the faces of one plane that `accepts` takes; zero-area faces go with whoever reaches them first.
class ChartGrower {
public:
    ChartGrower(const PlaneMesh& planes, double min_facing)
        : planes_(planes), min_facing_(min_facing), opposite_(opposite_half_edges(planes.mesh)),
          normal_(planes.mesh.face.size()), taken_(planes.mesh.face.size(), false)
    {
        for (FaceId f = 0; f < normal_.size(); ++f)
            normal_[f] = face_normal(planes.mesh, f);
    }

    bool taken(FaceId f) const { return taken_[f]; }
    const Eigen::Vector3d& normal(FaceId f) const { return normal_[f]; }
    bool faces(FaceId f, const Eigen::Vector3d& direction) const { return normal_[f].dot(direction) >= min_facing_; }

    std::vector<FaceId> grow(FaceId seed, const Eigen::Vector3d& direction)
    {
        std::vector<FaceId> piece{seed};
        taken_[seed] = true;
        for (std::size_t i = 0; i < piece.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                const auto other = opposite_[3 * std::size_t{piece[i]} + k];
                if (!is_half_edge(other)) continue;
                const FaceId f = other / 3;
                if (taken_[f] || planes_.face_plane[f] != planes_.face_plane[seed]) continue;
                if (!normal_[f].isZero() && !faces(f, direction)) continue;
                taken_[f] = true;
                piece.push_back(f);
            }
        std::ranges::sort(piece);
        return piece;
    }

private:
    const PlaneMesh& planes_;
    double min_facing_;
    std::vector<std::uint32_t> opposite_;
    std::vector<Eigen::Vector3d> normal_;
    std::vector<char> taken_;
};

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Andrew's monotone chain: the convex hull, counter-clockwise, without collinear points.
std::vector<Eigen::Vector2d> convex_hull(std::vector<Eigen::Vector2d> points)
{
    std::ranges::sort(points,
                      [](const auto& a, const auto& b) { return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); });
    std::vector<Eigen::Vector2d> hull;
    const auto extend = [&](const Eigen::Vector2d& p, std::size_t floor) {
        while (hull.size() >= floor + 2 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0.0)
            hull.pop_back();
        hull.push_back(p);
    };
    for (const auto& p : points)
        extend(p, 0);
    const std::size_t lower = hull.size() - 1;
    for (auto p = points.rbegin() + 1; p != points.rend(); ++p)
        extend(*p, lower);
    if (hull.size() > 1) hull.pop_back();
    return hull;
}

// Direction of the long side of the minimum-area rectangle; one of its sides lies on an edge of the hull.
Eigen::Vector2d long_side(const std::vector<Eigen::Vector2d>& points)
{
    const auto hull = convex_hull(points);
    Eigen::Vector2d best = Eigen::Vector2d::UnitX();
    double best_area = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Eigen::Vector2d edge = hull[(i + 1) % hull.size()] - hull[i];
        if (edge.squaredNorm() == 0.0) continue;
        const Eigen::Vector2d u = edge.normalized(), v(-u.y(), u.x());
        Eigen::AlignedBox2d box;
        for (const auto& p : hull)
            box.extend(Eigen::Vector2d(u.dot(p), v.dot(p)));
        const double area = box.volume();
        if (area >= best_area) continue;
        best_area = area;
        best = box.sizes().x() >= box.sizes().y() ? u : v;
    }
    return best;
}

void set_origin(Chart& chart, const TriangleMesh& mesh)
{
    Eigen::AlignedBox2d box;
    for (const FaceId f : chart.face)
        for (int k = 0; k < 3; ++k)
            box.extend(chart.from_world(corner(mesh, f, k)));
    chart.origin += box.min().x() * chart.axis_u + box.min().y() * chart.axis_v;
    chart.extent = box.sizes();
}

Chart lay_flat(const PlaneMesh& planes, std::vector<FaceId> faces, const Eigen::Vector3d& normal)
{
    Chart chart;
    chart.plane = planes.face_plane[faces.front()];
    chart.face = std::move(faces);
    chart.origin = corner(planes.mesh, chart.face.front(), 0);
    chart.axis_u = normal.unitOrthogonal();
    chart.axis_v = chart.axis_u.cross(normal);
    std::vector<Eigen::Vector2d> points;
    for (const FaceId f : chart.face)
        for (int k = 0; k < 3; ++k)
            points.push_back(chart.from_world(corner(planes.mesh, f, k)));
    const Eigen::Vector2d side = long_side(points);
    chart.axis_u = (side.x() * chart.axis_u + side.y() * chart.axis_v).normalized();
    chart.axis_v = chart.axis_u.cross(normal);
    set_origin(chart, planes.mesh);
    return chart;
}

// Pieces of a face set that are joined by edges.
std::vector<std::vector<FaceId>> connected_pieces(const TriangleMesh& mesh, const std::vector<FaceId>& faces)
{
    TriangleMesh part{mesh.position, {}, {}, {}};
    for (const FaceId f : faces)
        part.face.push_back(mesh.face[f]);
    const auto component = face_components(part);
    std::vector<std::vector<FaceId>> pieces;
    for (std::size_t i = 0; i < faces.size(); ++i) {
        if (component[i] >= pieces.size()) pieces.resize(component[i] + 1);
        pieces[component[i]].push_back(faces[i]);
    }
    return pieces;
}

Chart sub_chart(const PlaneMesh& planes, const Chart& chart, std::vector<FaceId> faces)
{
    Chart part = lay_flat(planes, std::move(faces), chart.normal());
    part.density = chart.density;
    return part;
}

// The faces that cover a texel centre which a larger face of the chart covers already.
std::vector<FaceId> overlapping_faces(const TriangleMesh& mesh, const Chart& chart)
{
    std::vector<FaceId> order = chart.face;
    std::ranges::stable_sort(order, [&](FaceId a, FaceId b) { return face_area(mesh, a) > face_area(mesh, b); });
    const Eigen::Vector2d size = chart.extent * chart.density;
    Image<std::uint8_t> covered(static_cast<int>(size.x()) + 1, static_cast<int>(size.y()) + 1);
    std::vector<FaceId> overlapping;
    for (const FaceId f : order) {
        const auto triangle = chart_triangle(mesh, chart, f);
        bool overlaps = false;
        for_each_texel(triangle, covered.width, covered.height, 0.0,
                       [&](int x, int y, double) { overlaps |= covered.at(x, y) != 0; });
        if (overlaps)
            overlapping.push_back(f);
        else
            for_each_texel(triangle, covered.width, covered.height, 0.0,
                           [&](int x, int y, double) { covered.at(x, y) = 1; });
    }
    std::ranges::sort(overlapping);
    return overlapping;
}

int longest_side(const Chart& chart) { return static_cast<int>(std::ceil(chart.extent.maxCoeff() * chart.density)); }

// Two charts of the faces before and behind the median along the longer axis.
std::pair<Chart, Chart> halves(const PlaneMesh& planes, const Chart& chart)
{
    const int axis = chart.extent.x() >= chart.extent.y() ? 0 : 1;
    const auto centre = [&](FaceId f) {
        double sum = 0.0;
        for (int k = 0; k < 3; ++k)
            sum += chart.from_world(corner(planes.mesh, f, k))[axis];
        return sum;
    };
    std::vector<FaceId> order = chart.face;
    std::ranges::stable_sort(order, [&](FaceId a, FaceId b) { return centre(a) < centre(b); });
    const auto middle = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
    std::vector<FaceId> first(order.begin(), middle), second(middle, order.end());
    std::ranges::sort(first);
    std::ranges::sort(second);
    return {sub_chart(planes, chart, std::move(first)), sub_chart(planes, chart, std::move(second))};
}

} // namespace

std::vector<Chart> make_charts(const PlaneMesh& planes, double min_facing)
{
    ChartGrower grower(planes, min_facing);
    std::vector<Chart> charts;
    const auto add = [&](FaceId seed, const Eigen::Vector3d& direction) {
        charts.push_back(lay_flat(planes, grower.grow(seed, direction), direction));
    };
    const auto face_count = static_cast<FaceId>(planes.mesh.face.size());
    for (FaceId f = 0; f < face_count; ++f)
        if (const auto& front = planes.plane[planes.face_plane[f]].normal; !grower.taken(f) && grower.faces(f, front))
            add(f, front);

    std::vector<FaceId> rest;
    for (FaceId f = 0; f < face_count; ++f)
        if (!grower.taken(f)) rest.push_back(f);
    std::ranges::stable_sort(rest,
                             [&](FaceId a, FaceId b) { return face_area(planes.mesh, a) > face_area(planes.mesh, b); });
    for (const FaceId f : rest)
        if (!grower.taken(f))
            add(f, grower.normal(f).isZero() ? planes.plane[planes.face_plane[f]].normal : grower.normal(f));
    return charts;
}

void split_overlaps(const PlaneMesh& planes, std::vector<Chart>& charts)
{
    for (std::size_t c = 0; c < charts.size(); ++c) { // charts grows: what was taken out may overlap itself
        const auto overlapping = overlapping_faces(planes.mesh, charts[c]);
        if (overlapping.empty()) continue;
        std::vector<FaceId> kept;
        std::ranges::set_difference(charts[c].face, overlapping, std::back_inserter(kept));
        const Chart whole = std::move(charts[c]);
        charts[c] = sub_chart(planes, whole, std::move(kept));
        for (auto& piece : connected_pieces(planes.mesh, overlapping))
            charts.push_back(sub_chart(planes, whole, std::move(piece)));
    }
}

void fit_charts(const PlaneMesh& planes, std::vector<Chart>& charts, int max_texels, double least_density)
{
    for (std::size_t c = 0; c < charts.size();) {
        Chart& chart = charts[c];
        if (longest_side(chart) > max_texels) {
            const double fitting = (max_texels - 1) / chart.extent.maxCoeff();
            chart.density = chart.face.size() > 1 ? std::max(fitting, std::min(chart.density, least_density)) : fitting;
        }
        if (longest_side(chart) <= max_texels) {
            ++c;
            continue;
        }
        auto [first, second] = halves(planes, chart);
        charts[c] = std::move(first);
        charts.push_back(std::move(second));
    }
}

void turn(Chart& chart)
{
    // The left end of the bottom edge becomes the top left corner.
    chart.origin += chart.extent.y() * chart.axis_v;
    const Eigen::Vector3d right = chart.axis_u;
    chart.axis_u = -chart.axis_v;
    chart.axis_v = right;
    std::swap(chart.extent.x(), chart.extent.y());
}

} // namespace quoin
