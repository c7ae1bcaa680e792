#include "merge/merge.h"

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "merge/neighbour_graph.h"
#include "merge/regularize.h"
#include "mesh/invariants.h"
#include "mesh/plane_fit.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <numbers>
#include <optional>
#include <queue>
#include <tuple>

// A rule looks at a larger cluster and a smaller neighbour and says by which distance [m] they would be joined, less
// first, or that they must not be.
namespace quoin {
namespace {

constexpr std::size_t kMergeGrain = 1 << 16; // [faces]

using Rule = std::function<std::optional<double>(PlaneId large, PlaneId small)>;

struct Candidate {
    double distance; // the smaller, the sooner [m]
    PlaneId a, b;    // a < b
    std::uint32_t version_a, version_b;
    bool operator>(const Candidate& other) const
    {
        return std::tie(distance, a, b) > std::tie(other.distance, other.a, other.b);
    }
};

void check(const PlaneMesh& mesh)
{
    const bool sizes = mesh.face_plane.size() == mesh.mesh.face.size() && mesh.moments.size() == mesh.plane.size() &&
                       mesh.vertex_class.size() == mesh.mesh.position.size();
    const bool ids = std::ranges::all_of(mesh.face_plane, [&](PlaneId p) { return p < mesh.plane.size(); });
    if (!sizes || !ids)
        throw InputError(fmt::format(
            "plane_mesh: {} faces with {} plane ids, {} planes with {} moments, {} vertices with {} classes: "
            "these do not fit together; run 'partition' again",
            mesh.mesh.face.size(), mesh.face_plane.size(), mesh.plane.size(), mesh.moments.size(),
            mesh.mesh.position.size(), mesh.vertex_class.size()));
}

double cosine_of(double degrees) { return std::cos(degrees * std::numbers::pi / 180.0); }

double cosine_between(const NeighbourGraph& graph, PlaneId a, PlaneId b)
{
    return graph.cluster(a).plane.normal.dot(graph.cluster(b).plane.normal);
}

double distance_to(const NeighbourGraph& graph, PlaneId large, PlaneId small)
{
    return rms_to_plane(graph.cluster(small).sum, graph.cluster(large).plane);
}

double rms_of_union(const NeighbourGraph& graph, PlaneId a, PlaneId b)
{
    return rms_to_fit(graph.cluster(a).sum + graph.cluster(b).sum);
}

// The paper's first two rules. The distance of the smaller cluster to the larger one's plane is tested too: in the RMS
// of the union a book vanishes on a large table.
Rule plane_rule(const NeighbourGraph& graph, const MergeParams& params)
{
    return [&graph, &params](PlaneId large, PlaneId small) -> std::optional<double> {
        if (params.angle_test && cosine_between(graph, large, small) < cosine_of(params.max_angle)) return {};
        const double rms = rms_of_union(graph, large, small);
        if (params.distance_test &&
            (rms > params.max_distance || distance_to(graph, large, small) > params.max_distance))
            return {};
        return rms;
    };
}

// The paper's rule of 2019, with guards on area, distance and angle, or it eats small real objects.
Rule energy_rule(const NeighbourGraph& graph, const MergeParams& params)
{
    return [&graph, &params](PlaneId large, PlaneId small) -> std::optional<double> {
        const auto &big = graph.cluster(large), &little = graph.cluster(small);
        if (little.sum.area > params.energy_area_ratio * big.sum.area) return {};
        if (cosine_between(graph, large, small) < cosine_of(params.energy_max_angle)) return {};
        if (distance_to(graph, large, small) > params.energy_max_distance) return {};
        const double increase = graph.energy(big.sum + little.sum) - big.energy - little.energy;
        if (!(increase < params.max_energy_increase * big.energy)) return {};
        return rms_of_union(graph, large, small);
    };
}

Rule island_rule(const NeighbourGraph& graph, const MergeParams& params)
{
    return [&graph, &params](PlaneId large, PlaneId small) -> std::optional<double> {
        const auto& island = graph.cluster(small);
        if (island.sum.area > params.island_max_area) return {};
        if (cosine_between(graph, large, small) < cosine_of(params.island_max_angle)) return {};
        double border = island.mesh_border;
        for (const auto& [other, length] : graph.borders(small))
            border += length;
        if (graph.borders(small).at(large) < params.island_border_share * border) return {};
        const double distance = distance_to(graph, large, small);
        return distance <= params.island_max_distance ? std::optional(distance) : std::nullopt;
    };
}

Rule absorb_rule(const NeighbourGraph& graph, const MergeParams& params)
{
    return [&graph, &params](PlaneId large, PlaneId small) -> std::optional<double> {
        if (graph.cluster(small).sum.area >= params.absorb_area) return {};
        if (cosine_between(graph, large, small) < cosine_of(params.absorb_max_angle)) return {};
        const double distance = distance_to(graph, large, small);
        return distance <= params.absorb_max_distance ? std::optional(distance) : std::nullopt;
    };
}

std::pair<PlaneId, PlaneId> large_and_small(const NeighbourGraph& graph, PlaneId a, PlaneId b)
{
    return graph.cluster(a).sum.area >= graph.cluster(b).sum.area ? std::pair(a, b) : std::pair(b, a);
}

void join_by(const Rule& rule, NeighbourGraph& graph)
{
    std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue;
    const auto offer = [&](PlaneId p, PlaneId q) {
        const auto [large, small] = large_and_small(graph, std::min(p, q), std::max(p, q));
        const auto distance = rule(large, small);
        if (!distance) return;
        const auto [a, b] = std::minmax(p, q);
        queue.push({*distance, a, b, graph.cluster(a).version, graph.cluster(b).version});
    };
    for (PlaneId a = 0; a < graph.size(); ++a)
        for (const auto& [b, length] : graph.borders(a))
            if (a < b) offer(a, b);
    while (!queue.empty()) {
        const Candidate next = queue.top();
        queue.pop();
        const bool alive = graph.is_alive(next.a) && graph.is_alive(next.b);
        if (!alive || next.version_a != graph.cluster(next.a).version ||
            next.version_b != graph.cluster(next.b).version)
            continue;
        const auto [large, small] = large_and_small(graph, next.a, next.b);
        graph.join(large, small);
        for (const auto& [other, length] : graph.borders(large))
            offer(large, other);
    }
}

// Ids of the result for all clusters, in the order of the first face; kNoPlane for those without faces.
std::vector<PlaneId> renumber(const PlaneMesh& mesh, const std::vector<PlaneId>& root, std::size_t& count)
{
    std::vector<PlaneId> id_of_root(root.size(), kNoPlane), id(root.size(), kNoPlane);
    count = 0;
    for (const PlaneId p : mesh.face_plane)
        if (PlaneId& root_id = id_of_root[root[p]]; root_id == kNoPlane) root_id = static_cast<PlaneId>(count++);
    for (std::size_t p = 0; p < root.size(); ++p)
        id[p] = id_of_root[root[p]];
    return id;
}

// Planes that are joined of several clusters are fitted anew; the others stay what they are.
std::vector<Plane> joined_planes(const PlaneMesh& mesh, const std::vector<PlaneId>& id, std::size_t count,
                                 const RobustFit& fit)
{
    std::vector<std::uint32_t> parts(count, 0);
    for (const PlaneId p : id)
        if (p != kNoPlane) ++parts[p];
    std::vector<PlaneId> joined(mesh.face_plane.size());
    parallel_for(
        joined.size(),
        [&](std::size_t f) {
            const PlaneId p = id[mesh.face_plane[f]];
            joined[f] = parts[p] > 1 ? p : kNoPlane;
        },
        kMergeGrain);
    std::vector<Plane> plane = fit_planes(mesh.mesh, joined, count, fit).plane;
    for (PlaneId p = 0; p < id.size(); ++p)
        if (id[p] != kNoPlane && parts[id[p]] == 1) plane[id[p]] = mesh.plane[p];
    return plane;
}

void classify_anew(BorderStrip& strip, const std::vector<PlaneId>& id, std::vector<VertexClass>& classes)
{
    for (PlaneId& p : strip.face_plane)
        p = id[p];
    const auto strip_class = classify_vertices(strip.mesh, strip.face_plane, strip.opposite);
    for (std::size_t v = 0; v < strip_class.size(); ++v)
        classes[strip.vertex[v]] = strip_class[v];
}

std::vector<std::pair<PlaneId, PlaneId>> neighbours(const NeighbourGraph& graph, const std::vector<PlaneId>& id)
{
    std::vector<std::pair<PlaneId, PlaneId>> pairs;
    for (PlaneId a = 0; a < graph.size(); ++a)
        for (const auto& [b, length] : graph.borders(a))
            if (a < b) pairs.emplace_back(id[a], id[b]);
    return pairs;
}

PlaneMesh relabelled(PlaneMesh mesh, const std::vector<PlaneId>& id, std::size_t count, BorderStrip strip,
                     const RobustFit& fit)
{
    std::vector<Moments> moments(count);
    for (PlaneId p = 0; p < id.size(); ++p)
        if (id[p] != kNoPlane) moments[id[p]] += mesh.moments[p];
    mesh.plane = joined_planes(mesh, id, count, fit);
    mesh.moments = std::move(moments);
    parallel_for(
        mesh.face_plane.size(), [&](std::size_t f) { mesh.face_plane[f] = id[mesh.face_plane[f]]; }, kMergeGrain);
    classify_anew(strip, id, mesh.vertex_class);
    return mesh;
}

} // namespace

PlaneMesh merge_planes(PlaneMesh mesh, const MergeParams& params)
{
    check(mesh);
    const std::size_t clusters = mesh.plane.size();
    BorderStrip strip = border_strip(mesh);
    NeighbourGraph graph(mesh, strip);
    if (params.angle_test || params.distance_test) join_by(plane_rule(graph, params), graph);
    if (params.energy_rule) join_by(energy_rule(graph, params), graph);
    if (params.island_rule) join_by(island_rule(graph, params), graph);
    if (params.absorb_rule) join_by(absorb_rule(graph, params), graph);
    std::size_t count = 0;
    const std::vector<PlaneId> id = renumber(mesh, graph.roots(), count);
    PlaneMesh result = relabelled(std::move(mesh), id, count, std::move(strip), {params.robust_rounds, params.tukey});
    if (params.regularize) result.plane = regularize(result.plane, result.moments, neighbours(graph, id), params);
    assert(broken_promise_of_planes(result).empty());
    log_info(fmt::format("{} clusters are {} planes", clusters, result.plane.size()));
    return result;
}

} // namespace quoin
