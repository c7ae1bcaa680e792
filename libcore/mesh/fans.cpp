#include "mesh/fans.h"

#include "base/parallel.h"
#include "mesh/adjacency.h"

#include <algorithm>
#include <atomic>
#include <utility>

namespace quoin {
namespace {

constexpr std::size_t kFanGrain = 1 << 14; // [vertices]
constexpr std::uint32_t kNoCorner = 0xffffffffu;

// Calls visit(corner) for the other corners that are reached from one by turning about its vertex `v`, first across the
// half-edge `h` of its face. Returns whether the last of them lies beside the first.
template <class Visit>
bool turn_about(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite, VertexId v, std::uint32_t h,
                const Visit& visit)
{
    const FaceId start = h / 3;
    while (is_half_edge(opposite[h])) {
        const std::uint32_t o = opposite[h], f = o / 3;
        if (f == start) return true;
        const auto k = static_cast<std::uint32_t>(std::ranges::find(mesh.face[f], v) - mesh.face[f].begin());
        visit(3 * f + k);
        const std::uint32_t out = 3 * f + k, in = 3 * f + (k + 2) % 3; // the half-edges from v and to v
        h = o == out ? in : out;
    }
    return false;
}

// The same for all other corners of the fan.
template <class Visit>
void for_fan(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite, std::uint32_t corner,
             const Visit& visit)
{
    const VertexId v = mesh.face[corner / 3][corner % 3];
    const std::uint32_t in = corner / 3 * 3 + (corner % 3 + 2) % 3;
    if (!turn_about(mesh, opposite, v, corner, visit)) turn_about(mesh, opposite, v, in, visit);
}

// Corners in the fan of some corner at each vertex, whichever it is: 1 for these. Where it is the only fan, all are.
std::vector<std::uint8_t> corners_in_some_fan(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite)
{
    std::vector<std::uint32_t> some_corner(mesh.position.size(), kNoCorner);
    parallel_for(
        opposite.size(),
        [&](std::size_t c) {
            std::atomic_ref(some_corner[mesh.face[c / 3][c % 3]])
                .store(static_cast<std::uint32_t>(c), std::memory_order_relaxed);
        },
        kFanGrain);
    std::vector<std::uint8_t> reached(opposite.size(), 0);
    parallel_for(
        some_corner.size(),
        [&](std::size_t v) {
            if (some_corner[v] == kNoCorner) return;
            reached[some_corner[v]] = 1;
            for_fan(mesh, opposite, some_corner[v], [&](std::uint32_t c) { reached[c] = 1; });
        },
        kFanGrain);
    return reached;
}

struct VertexCorner {
    VertexId vertex = 0;
    std::uint32_t corner = 0;
    auto operator<=>(const VertexCorner&) const = default;
};

// Corners at vertices that have more than one fan, sorted.
std::vector<VertexCorner> corners_of_touched(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite)
{
    const auto reached = corners_in_some_fan(mesh, opposite);
    const auto vertex = [&](std::size_t c) { return mesh.face[c / 3][c % 3]; };
    const auto beside =
        parallel_select<std::uint32_t>(reached.size(), kFanGrain, [&](std::size_t c) { return reached[c] == 0; });
    if (beside.empty()) return {};
    std::vector<std::uint8_t> touched(mesh.position.size(), 0);
    for (const std::uint32_t c : beside)
        touched[vertex(c)] = 1;
    std::vector<VertexCorner> corners;
    for (const auto c : parallel_select<std::uint32_t>(reached.size(), kFanGrain,
                                                       [&](std::size_t i) { return touched[vertex(i)] != 0; }))
        corners.push_back({vertex(c), c});
    std::ranges::sort(corners);
    return corners;
}

// Corners of every fan, the smallest first, but of those whose smallest is the first at its vertex.
std::vector<std::vector<std::uint32_t>> spare_fans(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite)
{
    const auto corners = corners_of_touched(mesh, opposite);
    std::vector<std::uint8_t> in_fan(corners.size(), 0);
    std::vector<std::vector<std::uint32_t>> fans;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const auto [v, corner] = corners[i];
        const bool keeps_vertex = i == 0 || corners[i - 1].vertex != v;
        if (std::exchange(in_fan[i], std::uint8_t{1}) != 0) continue;
        std::vector<std::uint32_t> fan{corner};
        for_fan(mesh, opposite, corner, [&](std::uint32_t c) {
            fan.push_back(c);
            const auto at = std::ranges::lower_bound(corners, VertexCorner{corners[i].vertex, c});
            in_fan[static_cast<std::size_t>(at - corners.begin())] = 1;
        });
        if (!keeps_vertex) fans.push_back(std::move(fan));
    }
    std::ranges::sort(fans, {}, [](const auto& fan) { return fan.front(); });
    return fans;
}

} // namespace

std::size_t split_touching_fans(TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite)
{
    const auto copy = [](auto& values, VertexId v) {
        if (!values.empty()) values.push_back(values[v]);
    };
    const auto fans = spare_fans(mesh, opposite);
    for (const auto& fan : fans) {
        const VertexId v = mesh.face[fan.front() / 3][fan.front() % 3];
        for (const std::uint32_t c : fan)
            mesh.face[c / 3][c % 3] = static_cast<VertexId>(mesh.position.size());
        copy(mesh.color, v);
        copy(mesh.normal, v);
        copy(mesh.position, v);
    }
    return fans.size();
}

} // namespace quoin
