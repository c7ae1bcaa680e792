#include "fill/pockets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace quoin {
namespace {

using Eigen::Vector3d;

constexpr double kMouth = 0.34;         // most of a bay's border that its mouth may be
constexpr std::size_t kMostEdges = 400; // of a bay
constexpr std::size_t kMostTries = 3000;

// The bay that runs along the loop from one vertex to another.
struct Bay {
    std::size_t begin = 0, edges = 0;
    double ratio = 0.0; // of mouth to border
};

class BaySearch {
public:
    BaySearch(const PlaneMesh& mesh, const BorderLoop& loop, double widest)
        : outline_(outline_of(mesh, loop)), widest_(widest), along_(loop.vertex.size() + 1, 0.0)
    {
        for (std::size_t i = 0; i < size(); ++i)
            along_[i + 1] = along_[i] + (outline_.position[(i + 1) % size()] - outline_.position[i]).norm();
    }

    // Narrow mouths first.
    std::vector<Bay> find() const
    {
        std::map<std::array<int, 3>, std::vector<std::size_t>> cells;
        for (std::size_t i = 0; i < size(); ++i)
            cells[cell_of(i, {0, 0, 0})].push_back(i);
        std::vector<Bay> bays;
        for (std::size_t i = 0; i < size(); ++i)
            for (int dx = -1; dx <= 1; ++dx)
                for (int dy = -1; dy <= 1; ++dy)
                    for (int dz = -1; dz <= 1; ++dz)
                        if (const auto near = cells.find(cell_of(i, {dx, dy, dz})); near != cells.end())
                            for (const std::size_t j : near->second)
                                add_if_narrow(i, j, bays);
        std::ranges::stable_sort(bays, {}, &Bay::ratio);
        return bays;
    }

    const Vector3d& at(std::size_t i) const { return outline_.position[i % size()]; }
    std::size_t size() const { return outline_.vertex.size(); }

private:
    std::array<int, 3> cell_of(std::size_t i, const std::array<int, 3>& shift) const
    {
        const Vector3d& p = outline_.position[i];
        const auto index = [&](int c) {
            return static_cast<int>(std::floor(p[c] / widest_)) + shift[static_cast<std::size_t>(c)];
        };
        return {index(0), index(1), index(2)};
    }

    void add_if_narrow(std::size_t i, std::size_t j, std::vector<Bay>& bays) const
    {
        const std::size_t edges = (j + size() - i) % size();
        if (edges < 2 || edges > kMostEdges || edges + 2 > size()) return;
        const double mouth = (at(j) - at(i)).norm();
        const double border = j > i ? along_[j] - along_[i] : along_.back() - along_[i] + along_[j];
        if (mouth <= widest_ && mouth <= kMouth * border) bays.push_back({i, edges, mouth / border});
    }

    Outline outline_;
    double widest_;
    std::vector<double> along_;
};

BorderLoop loop_of(const BorderLoop& loop, const Bay& bay)
{
    BorderLoop piece;
    for (std::size_t k = 0; k <= bay.edges; ++k) {
        const std::size_t i = (bay.begin + k) % loop.vertex.size();
        piece.vertex.push_back(loop.vertex[i]);
        piece.plane.push_back(k < bay.edges ? loop.plane[i] : kNoPlane);
        if (k < bay.edges) piece.face.push_back(loop.face[i]);
    }
    return piece;
}

// Is a point on the front or back of a face of the patch, nearer than `height`?
bool covers(const PlaneMesh& mesh, const Patch& patch, const Vector3d& point, double height)
{
    const std::size_t known = mesh.mesh.position.size();
    const auto at = [&](VertexId v) -> Vector3d {
        return v < known ? mesh.mesh.position[v].cast<double>() : patch.vertex[v - known];
    };
    for (std::size_t f = 0; f < patch.face.size(); ++f) {
        const Outline face{{}, {at(patch.face[f][0]), at(patch.face[f][1]), at(patch.face[f][2])}};
        const Plane& plane = mesh.plane[patch.plane[f]];
        if (std::abs(plane.signed_distance(point)) <= height && encloses(face, plane, point)) return true;
    }
    return false;
}

bool is_tried(const std::vector<Bay>& tried, const Bay& bay)
{
    constexpr std::size_t kNear = 2; // vertices
    const auto near = [](std::size_t a, std::size_t b) { return a > b ? a - b <= kNear : b - a <= kNear; };
    return std::ranges::any_of(tried, [&](const Bay& other) {
        return near(other.begin, bay.begin) && near(other.begin + other.edges, bay.begin + bay.edges);
    });
}

} // namespace

std::vector<Patch> close_pockets(const PlaneMesh& mesh, const BorderLoop& loop, const Proposer& proposer,
                                 const FillHolesParams& params)
{
    const BaySearch search(mesh, loop, std::max(params.max_gap, 1e-3));
    const std::size_t n = search.size();
    std::vector<bool> is_closed(n, false); // vertices that are no longer on the border
    std::vector<Bay> tried;
    std::vector<Patch> patches;
    for (const Bay& bay : search.find()) {
        bool is_free = true;
        for (std::size_t k = 0; k <= bay.edges; ++k)
            is_free = is_free && !is_closed[(bay.begin + k) % n];
        if (!is_free || is_tried(tried, bay)) continue;
        if (tried.size() >= kMostTries) break;
        tried.push_back(bay);
        auto patch = proposer.propose_bay(loop_of(loop, bay));
        if (!patch) continue;
        bool is_over_others = false;
        for (std::size_t k = bay.edges + 1; k < n && !is_over_others; ++k)
            is_over_others = covers(mesh, *patch, search.at(bay.begin + k), params.plane_distance);
        if (is_over_others) continue;
        for (std::size_t k = 1; k < bay.edges; ++k)
            is_closed[(bay.begin + k) % n] = true;
        patches.push_back(std::move(*patch));
    }
    return patches;
}

} // namespace quoin
