#include "report/coarsen.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

namespace quoin {
namespace {

// The cell of every vertex, numbered in order of the grid.
struct Cells {
    std::vector<std::uint32_t> of_vertex;
    std::size_t count = 0;
};

Cells cells_of(const TriangleMesh& mesh, float cell_size)
{
    Eigen::AlignedBox3f box;
    for (const auto& p : mesh.position)
        box.extend(p);
    constexpr int kBits = 21; // of each coordinate
    std::vector<std::uint64_t> key(mesh.position.size());
    for (std::size_t v = 0; v < key.size(); ++v) {
        const Eigen::Array3f place = ((mesh.position[v] - box.min()) / cell_size).array().floor();
        for (int c = 0; c < 3; ++c)
            key[v] = key[v] << kBits | static_cast<std::uint64_t>(place[c]);
    }
    std::vector<std::uint64_t> distinct = key;
    std::ranges::sort(distinct);
    distinct.erase(std::ranges::unique(distinct).begin(), distinct.end());
    Cells cells{std::vector<std::uint32_t>(key.size()), distinct.size()};
    for (std::size_t v = 0; v < key.size(); ++v)
        cells.of_vertex[v] = static_cast<std::uint32_t>(std::ranges::lower_bound(distinct, key[v]) - distinct.begin());
    return cells;
}

TriangleMesh join_cells(const TriangleMesh& mesh, const Cells& cells)
{
    std::vector<Eigen::Vector3f> position(cells.count, Eigen::Vector3f::Zero()), color = position;
    std::vector<float> weight(cells.count, 0.0f);
    for (std::size_t v = 0; v < mesh.position.size(); ++v) {
        const auto cell = cells.of_vertex[v];
        position[cell] += mesh.position[v];
        if (!mesh.color.empty()) color[cell] += Eigen::Vector3f(mesh.color[v][0], mesh.color[v][1], mesh.color[v][2]);
        weight[cell] += 1.0f;
    }
    TriangleMesh coarse;
    for (std::size_t c = 0; c < cells.count; ++c) {
        coarse.position.push_back(position[c] / weight[c]);
        const Eigen::Vector3f mean = color[c] / weight[c];
        if (!mesh.color.empty())
            coarse.color.push_back({static_cast<std::uint8_t>(std::lround(mean[0])),
                                    static_cast<std::uint8_t>(std::lround(mean[1])),
                                    static_cast<std::uint8_t>(std::lround(mean[2]))});
    }
    for (const auto& face : mesh.face) {
        const Face moved{cells.of_vertex[face[0]], cells.of_vertex[face[1]], cells.of_vertex[face[2]]};
        if (moved[0] != moved[1] && moved[1] != moved[2] && moved[2] != moved[0]) coarse.face.push_back(moved);
    }
    return coarse;
}

} // namespace

TriangleMesh coarsen(const TriangleMesh& mesh, std::size_t max_faces)
{
    TriangleMesh coarse{mesh.position, mesh.face, mesh.color, {}};
    if (mesh.face.size() <= max_faces) return coarse;
    // Two faces a vertex, and as many cells as a surface of this area has: cell^2 = 2 area / faces.
    const double area =
        std::accumulate(mesh.face.begin(), mesh.face.end(), 0.0,
                        [&, f = FaceId{0}](double sum, const Face&) mutable { return sum + face_area(mesh, f++); });
    constexpr double kGrowth = 1.15;
    for (double cell = std::sqrt(2.0 * area / static_cast<double>(max_faces)); coarse.face.size() > max_faces;
         cell *= kGrowth)
        coarse = join_cells(mesh, cells_of(mesh, static_cast<float>(cell)));
    return coarse;
}

} // namespace quoin
