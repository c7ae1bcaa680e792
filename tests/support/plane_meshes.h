// Small meshes of planes with known truth: what simplification and geometry optimisation are tested on.
#pragma once

#include "mesh/plane_mesh.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

namespace quoin::testing_support {

// A subdivided parallelogram: cells x cells squares, each two triangles, facing u x v.
struct Sheet {
    Eigen::Vector3d origin, u, v; // [m]
    int cells = 1;
};

// Joins sheets into one mesh, vertices at equal places (to 1e-6 m) once, one plane a sheet with its exact moments.
inline PlaneMesh join_sheets(const std::vector<Sheet>& sheets)
{
    PlaneMesh mesh;
    std::vector<std::pair<std::array<long, 3>, VertexId>> known;
    const auto vertex_at = [&](const Eigen::Vector3d& p) {
        const std::array<long, 3> key{std::lround(p.x() * 1e6), std::lround(p.y() * 1e6), std::lround(p.z() * 1e6)};
        const auto it = std::lower_bound(known.begin(), known.end(), std::pair(key, VertexId{0}));
        if (it != known.end() && it->first == key) return it->second;
        mesh.mesh.position.push_back(p.cast<float>());
        const auto id = static_cast<VertexId>(mesh.mesh.position.size() - 1);
        known.insert(it, {key, id});
        return id;
    };
    for (const Sheet& sheet : sheets) {
        const auto id = static_cast<PlaneId>(mesh.plane.size());
        const Eigen::Vector3d normal = sheet.u.cross(sheet.v).normalized();
        mesh.plane.push_back({normal, -normal.dot(sheet.origin)});
        Moments moments;
        const auto at = [&](int i, int j) -> Eigen::Vector3d {
            return sheet.origin + sheet.u * i / sheet.cells + sheet.v * j / sheet.cells;
        };
        for (int j = 0; j < sheet.cells; ++j) {
            for (int i = 0; i < sheet.cells; ++i) {
                const VertexId a = vertex_at(at(i, j)), b = vertex_at(at(i + 1, j)), c = vertex_at(at(i + 1, j + 1)),
                               d = vertex_at(at(i, j + 1));
                mesh.mesh.face.push_back({a, b, c});
                mesh.mesh.face.push_back({a, c, d});
                mesh.face_plane.insert(mesh.face_plane.end(), 2, id);
                moments += triangle_moments(at(i, j), at(i + 1, j), at(i + 1, j + 1));
                moments += triangle_moments(at(i, j), at(i + 1, j + 1), at(i, j + 1));
            }
        }
        mesh.moments.push_back(moments);
    }
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
    return mesh;
}

// A closed box from the origin to `size`, faces outwards, six planes.
inline PlaneMesh box(const Eigen::Vector3d& size, int cells)
{
    const Eigen::Vector3d o = Eigen::Vector3d::Zero(), x = size.x() * Eigen::Vector3d::UnitX(),
                          y = size.y() * Eigen::Vector3d::UnitY(), z = size.z() * Eigen::Vector3d::UnitZ();
    return join_sheets(
        {{o, y, x, cells}, {z, x, y, cells}, {o, x, z, cells}, {y, z, x, cells}, {o, z, y, cells}, {x, y, z, cells}});
}

// Floor and wall that meet at a right angle along the x axis: an open mesh with one crease.
inline PlaneMesh l_corner(int cells)
{
    const Eigen::Vector3d o = Eigen::Vector3d::Zero();
    return join_sheets({{o, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), cells},
                        {o, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX(), cells}});
}

// Floor and two walls seen from inside: an open mesh with three creases and a corner.
inline PlaneMesh room_corner(int cells)
{
    const Eigen::Vector3d o = Eigen::Vector3d::Zero(), x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                          z = Eigen::Vector3d::UnitZ();
    return join_sheets({{o, x, y, cells}, {o, y, z, cells}, {o, z, x, cells}});
}

// Moves every vertex by independent normal noise [m].
inline PlaneMesh with_noise(PlaneMesh mesh, float sigma, unsigned seed = 1)
{
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(0.0f, sigma);
    for (auto& p : mesh.mesh.position)
        p += Eigen::Vector3f(noise(random), noise(random), noise(random));
    return mesh;
}

} // namespace quoin::testing_support
