// Small meshes with known planes.
#pragma once

#include "mesh/plane_mesh.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <random>

namespace quoin::test {

// A grid of n x m quads, two faces each, on the parallelogram origin + s u + t v; its normal is u x v. Vertices move
// along the normal by Gaussian noise [m].
inline TriangleMesh grid(const Eigen::Vector3d& origin, const Eigen::Vector3d& u, const Eigen::Vector3d& v, int n,
                         int m, double noise = 0.0, unsigned seed = 1)
{
    std::mt19937 random(seed);
    std::normal_distribution<double> deviation(0.0, 1.0);
    const Eigen::Vector3d normal = u.cross(v).normalized();
    TriangleMesh mesh;
    for (int j = 0; j <= m; ++j)
        for (int i = 0; i <= n; ++i) {
            const Eigen::Vector3d p =
                origin + double(i) / n * u + double(j) / m * v + noise * deviation(random) * normal;
            mesh.position.push_back(p.cast<float>());
        }
    const auto id = [&](int i, int j) { return static_cast<VertexId>(j * (n + 1) + i); };
    for (int j = 0; j < m; ++j)
        for (int i = 0; i < n; ++i) {
            mesh.face.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
            mesh.face.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
        }
    return mesh;
}

inline void append(TriangleMesh& mesh, const TriangleMesh& other)
{
    const auto offset = static_cast<VertexId>(mesh.position.size());
    mesh.position.insert(mesh.position.end(), other.position.begin(), other.position.end());
    for (const auto& f : other.face)
        mesh.face.push_back({f[0] + offset, f[1] + offset, f[2] + offset});
}

// The square [0,1]^2 as a height field of n x n quads over z(x, y).
template <class Height>
TriangleMesh height_field(int n, const Height& z)
{
    TriangleMesh mesh = grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, n, n);
    for (auto& p : mesh.position)
        p.z() = static_cast<float>(z(p.x(), p.y()));
    return mesh;
}

// Makes one vertex of vertices at the same position, to a micrometre.
inline TriangleMesh welded(const TriangleMesh& mesh)
{
    TriangleMesh result;
    std::map<std::array<std::int64_t, 3>, VertexId> seen;
    std::vector<VertexId> id;
    for (const auto& p : mesh.position) {
        const std::array<std::int64_t, 3> key{std::llround(1e6 * p.x()), std::llround(1e6 * p.y()),
                                              std::llround(1e6 * p.z())};
        const auto [it, added] = seen.try_emplace(key, static_cast<VertexId>(result.position.size()));
        if (added) result.position.push_back(p);
        id.push_back(it->second);
    }
    for (const auto& f : mesh.face)
        result.face.push_back({id[f[0]], id[f[1]], id[f[2]]});
    return result;
}

inline void add_noise(TriangleMesh& mesh, double noise, unsigned seed)
{
    std::mt19937 random(seed);
    std::normal_distribution<double> deviation(0.0, 1.0);
    for (auto& p : mesh.position)
        for (int k = 0; k < 3; ++k)
            p[k] += static_cast<float>(noise * deviation(random));
}

// A floor and two walls that meet in a corner: unit squares of n x n quads in one connected mesh.
inline TriangleMesh room_corner(int n, double noise, unsigned seed = 1)
{
    TriangleMesh mesh;
    append(mesh, grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, n, n));
    append(mesh, grid({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, n, n));
    append(mesh, grid({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, n, n));
    mesh = welded(mesh);
    add_noise(mesh, noise, seed);
    return mesh;
}

// An octahedron, subdivided and blown up.
inline TriangleMesh sphere(int levels, double radius)
{
    TriangleMesh mesh;
    mesh.position = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.face = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<VertexId, VertexId>, VertexId> middle;
        const auto split = [&](VertexId a, VertexId b) {
            const auto [it, added] = middle.try_emplace(std::minmax(a, b), static_cast<VertexId>(mesh.position.size()));
            if (added) mesh.position.push_back((mesh.position[a] + mesh.position[b]).normalized());
            return it->second;
        };
        std::vector<Face> faces;
        for (const auto& [a, b, c] : mesh.face) {
            const VertexId ab = split(a, b), bc = split(b, c), ca = split(c, a);
            faces.insert(faces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        mesh.face = std::move(faces);
    }
    for (auto& p : mesh.position)
        p = p.normalized() * static_cast<float>(radius);
    return mesh;
}

} // namespace quoin::test
