#include "partition/partition.h"

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "mesh/adjacency.h"
#include "mesh/extent.h"
#include "mesh/invariants.h"
#include "mesh/plane_fit.h"
#include "partition/cluster_graph.h"
#include "partition/grow_regions.h"
#include "partition/merge_heap.h"
#include "partition/merge_rounds.h"
#include "partition/refine_borders.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace quoin {
namespace {

void check_vertex(const TriangleMesh& mesh, FaceId f, VertexId v)
{
    if (v >= mesh.position.size())
        throw InputError(
            fmt::format("mesh: face {} uses vertex {}, but there are {} vertices; the mesh is damaged, make it anew", f,
                        v, mesh.position.size()));
    if (!mesh.position[v].allFinite())
        throw InputError(fmt::format(
            "mesh: face {} uses vertex {}, whose position is not finite; clean the mesh up first, as 'fuse' does", f,
            v));
}

constexpr std::size_t kFaceGrain = 1 << 14;

bool is_sound(const TriangleMesh& mesh, const Face& face)
{
    return std::ranges::all_of(face,
                               [&](VertexId v) { return v < mesh.position.size() && mesh.position[v].allFinite(); });
}

// Returns the mesh's bounding box.
Eigen::AlignedBox3f require_partitionable(const TriangleMesh& mesh)
{
    struct Extent {
        double area = 0.0;
        Eigen::AlignedBox3f box;
    };
    const auto measure = [&](std::size_t begin, std::size_t end) {
        Extent extent;
        for (std::size_t f = begin; f < end; ++f) {
            if (!is_sound(mesh, mesh.face[f]))
                for (const VertexId v : mesh.face[f])
                    check_vertex(mesh, static_cast<FaceId>(f), v);
            extent.area += face_area(mesh, static_cast<FaceId>(f));
            for (const VertexId v : mesh.face[f])
                extent.box.extend(mesh.position[v]);
        }
        return extent;
    };
    const Extent extent =
        parallel_reduce(mesh.face.size(), kFaceGrain, Extent(), measure, [](const Extent& x, const Extent& y) {
            return Extent{x.area + y.area, x.box.merged(y.box)};
        });
    if (!(extent.area > 0.0))
        throw ImpossibleError(
            fmt::format("mesh: none of its {} faces has an area, so there is no plane to find; check the scan's depth",
                        mesh.face.size()));
    return extent.box;
}

MergeLimits limits_of(const Eigen::AlignedBox3f& box, const PartitionParams& params)
{
    constexpr double kRounding = 1e-7; // of single precision coordinates
    const double rounding = kRounding * box.diagonal().cast<double>().norm();
    if (params.clusters > 0) return {kForbidden, params.min_facing, -1.0, rounding * rounding};
    return {params.max_error, params.min_facing, std::cos(params.max_part_angle * std::numbers::pi / 180.0),
            rounding * rounding};
}

std::size_t count_floaters(const TriangleMesh& mesh, double floater_area)
{
    const auto component = face_components(mesh);
    std::vector<double> area(1 + *std::max_element(component.begin(), component.end()), 0.0);
    for (FaceId f = 0; f < component.size(); ++f)
        area[component[f]] += face_area(mesh, f);
    return static_cast<std::size_t>(
        std::count_if(area.begin(), area.end(), [&](double a) { return a < floater_area; }));
}

// Clusters at which growth ends; 1 while it ends by error.
std::size_t target_count(const TriangleMesh& mesh, const PartitionParams& params)
{
    if (params.clusters == 0) return 1;
    return static_cast<std::size_t>(params.clusters) + count_floaters(mesh, params.floater_area);
}

// Clusters at which the rounds hand over to the exact heap. The heap alone decides about the last `round_reserve` times
// the target, where the greedy order matters most: the energy stays within 1 % of the exact one.
std::size_t handover(std::size_t faces, std::size_t target, const PartitionParams& params)
{
    return std::max(faces / static_cast<std::size_t>(params.round_faces),
                    static_cast<std::size_t>(params.round_reserve) * target);
}

ClusterGraph grow_in_rounds(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite,
                            const MergeLimits& limits, std::size_t stop_count)
{
    Progress progress("growing clusters in rounds", mesh.face.size());
    return clusters_of_blocks(mesh, opposite, limits, [&](ClusterGraph& block) {
        const std::size_t faces = block.face_cluster.size();
        merge_in_rounds(block, faces * stop_count / mesh.face.size());
        progress.step(faces);
    });
}

std::vector<PlaneId> grow_clusters(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite,
                                   const MergeLimits& limits, const PartitionParams& params)
{
    const std::size_t target = target_count(mesh, params);
    ClusterGraph graph = params.method == GrowthMethod::Hybrid
                             ? grow_in_rounds(mesh, opposite, limits, handover(mesh.face.size(), target, params))
                             : clusters_of_faces(mesh, opposite, limits);
    if (params.method == GrowthMethod::RegionGrowing)
        grow_regions(graph, opposite, {params.max_error, std::cos(params.grow_angle * std::numbers::pi / 180.0)});
    merge_by_heap(graph, target);
    return cluster_labels(graph);
}

void refine(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite, const MergeLimits& limits,
            const PartitionParams& params, std::vector<PlaneId>& face_plane)
{
    if (params.refine_rounds == 0) return;
    refine_borders(mesh, opposite,
                   {static_cast<double>(params.refine_rounds), params.border_distance, limits.max_error,
                    limits.min_facing, limits.min_part_cosine, limits.flat_variance},
                   face_plane);
}

PlaneMesh with_planes(TriangleMesh mesh, std::vector<PlaneId> face_plane, const std::vector<std::uint32_t>& opposite,
                      const RobustFit& fit)
{
    const std::size_t planes = 1 + *std::max_element(face_plane.begin(), face_plane.end());
    PlaneMesh result;
    FittedPlanes fitted = fit_planes(mesh, face_plane, planes, fit);
    result.vertex_class = classify_vertices(mesh, face_plane, opposite);
    result.mesh = std::move(mesh);
    result.plane = std::move(fitted.plane);
    result.moments = std::move(fitted.moments);
    result.face_plane = std::move(face_plane);
    return result;
}

} // namespace

PlaneMesh partition(TriangleMesh mesh, const PartitionParams& params)
{
    const Eigen::AlignedBox3f box = require_partitionable(mesh);
    warn_about_extent(box, params.plausible_extent);
    const MergeLimits limits = limits_of(box, params);
    const auto opposite = opposite_half_edges(mesh);
    std::vector<PlaneId> face_plane = grow_clusters(mesh, opposite, limits, params);
    refine(mesh, opposite, limits, params, face_plane);
    PlaneMesh result =
        with_planes(std::move(mesh), std::move(face_plane), opposite, {params.robust_rounds, params.tukey});
    assert(broken_promise_of_planes(result).empty());
    log_info(fmt::format("{} faces in {} clusters", result.mesh.face.size(), result.plane.size()));
    return result;
}

} // namespace quoin
