#include "alignment/samples.h"

#include "base/parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <tuple>

namespace quoin {
namespace {

constexpr int kTileBits = 4; // 16 x 16 texels: their pictures stay within a few pages of memory, whatever way is up

struct GridPoint {
    int row, column;
    Eigen::Vector3f p_world;
};

// Faces of every plane, ascending: those of plane p are face[first[p]] .. face[first[p + 1] - 1].
struct PlaneFaces {
    std::vector<std::uint32_t> first;
    std::vector<FaceId> face;
    std::span<const FaceId> of(PlaneId p) const { return {face.data() + first[p], first[p + 1] - first[p]}; }
};

PlaneFaces faces_of_planes(const PlaneMesh& mesh)
{
    PlaneFaces faces;
    faces.first.assign(mesh.plane.size() + 1, 0);
    for (const PlaneId p : mesh.face_plane)
        ++faces.first[p + 1];
    for (std::size_t p = 0; p < mesh.plane.size(); ++p)
        faces.first[p + 1] += faces.first[p];
    faces.face.resize(mesh.face_plane.size());
    auto next = faces.first;
    for (FaceId f = 0; f < mesh.face_plane.size(); ++f)
        faces.face[next[mesh.face_plane[f]]++] = f;
    return faces;
}

// The grid of a plane: points axes^T (p - origin) / spacing with integer coordinates.
struct Grid {
    Eigen::Matrix<double, 2, 3> axes; // [1/m]
    Eigen::Vector3d origin;
    Eigen::Vector2d at(const Eigen::Vector3d& p) const { return axes * (p - origin); }
};

Grid grid_of(const Plane& plane, double spacing)
{
    Grid grid;
    const Eigen::Vector3d u = plane.normal.unitOrthogonal();
    grid.axes << u.transpose() / spacing, plane.normal.cross(u).transpose() / spacing;
    grid.origin = -plane.offset * plane.normal;
    return grid;
}

void add_face(std::vector<GridPoint>& points, const Grid& grid, const std::array<Eigen::Vector3d, 3>& v)
{
    const std::array<Eigen::Vector2d, 3> g{grid.at(v[0]), grid.at(v[1]), grid.at(v[2])};
    const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); };
    const double area = cross(g[1] - g[0], g[2] - g[0]);
    if (!std::isfinite(area) || area == 0.0) return;
    const Eigen::Vector2d low = g[0].cwiseMin(g[1]).cwiseMin(g[2]), high = g[0].cwiseMax(g[1]).cwiseMax(g[2]);
    for (int row = static_cast<int>(std::ceil(low.y())); row <= high.y(); ++row)
        for (int column = static_cast<int>(std::ceil(low.x())); column <= high.x(); ++column) {
            const Eigen::Vector2d d = Eigen::Vector2d(column, row) - g[0];
            const double b1 = cross(d, g[2] - g[0]) / area, b2 = cross(g[1] - g[0], d) / area;
            if (b1 < 0.0 || b2 < 0.0 || b1 + b2 > 1.0) continue;
            const Eigen::Vector3d p = v[0] + b1 * (v[1] - v[0]) + b2 * (v[2] - v[0]);
            points.push_back({row, column, p.cast<float>()});
        }
}

std::vector<GridPoint> sample_plane(const PlaneMesh& mesh, PlaneId plane, std::span<const FaceId> faces, double spacing)
{
    std::vector<GridPoint> points;
    const Grid grid = grid_of(mesh.plane[plane], spacing);
    for (const FaceId f : faces)
        add_face(points, grid, {corner(mesh.mesh, f, 0), corner(mesh.mesh, f, 1), corner(mesh.mesh, f, 2)});
    // Arithmetic shifts: tiles go on evenly below zero.
    const auto place = [](const GridPoint& p) {
        return std::tuple(p.row >> kTileBits, p.column >> kTileBits, p.row, p.column);
    };
    std::ranges::stable_sort(points, {}, place);
    const auto repeated = std::ranges::unique(points, {}, place);
    points.erase(repeated.begin(), repeated.end());
    return points;
}

} // namespace

Texels sample_texels(const PlaneMesh& mesh, double spacing)
{
    const PlaneFaces faces = faces_of_planes(mesh);
    std::vector<std::vector<GridPoint>> points(mesh.plane.size());
    parallel_for(points.size(), [&](std::size_t p) {
        points[p] = sample_plane(mesh, static_cast<PlaneId>(p), faces.of(static_cast<PlaneId>(p)), spacing);
    });
    Texels texels;
    texels.spacing = spacing;
    texels.first_of_plane.push_back(0);
    for (PlaneId p = 0; p < points.size(); ++p) {
        for (const GridPoint& point : points[p]) {
            texels.p_world.push_back(point.p_world);
            texels.plane.push_back(p);
            texels.cell.push_back({point.column, point.row});
        }
        texels.first_of_plane.push_back(static_cast<std::uint32_t>(texels.size()));
    }
    return texels;
}

Texels kept(const Texels& texels, const std::vector<std::uint8_t>& keep)
{
    Texels result;
    result.spacing = texels.spacing;
    result.first_of_plane.assign(texels.first_of_plane.size(), 0);
    for (TexelId t = 0; t < texels.size(); ++t) {
        if (!keep[t]) continue;
        result.p_world.push_back(texels.p_world[t]);
        result.plane.push_back(texels.plane[t]);
        result.cell.push_back(texels.cell[t]);
        result.first_of_plane[texels.plane[t] + 1] = static_cast<std::uint32_t>(result.size());
    }
    for (std::size_t p = 1; p < result.first_of_plane.size(); ++p)
        result.first_of_plane[p] = std::max(result.first_of_plane[p], result.first_of_plane[p - 1]);
    return result;
}

} // namespace quoin
