#include "fusion/fuse.h"

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "fusion/depth_view.h"
#include "fusion/extract.h"
#include "fusion/integrate.h"
#include "fusion/typical_weight.h"
#include "fusion/voxel_grid.h"
#include "mesh/cleanup.h"
#include "mesh/extent.h"
#include "mesh/ply.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace quoin {
namespace {

// Frames that are decoded and integrated together: as many as stay in the last-level cache. Results depend on it, so it
// is the same on every machine.
constexpr std::size_t kBatch = 16;
constexpr double kBytesPerGigabyte = 1e9;
constexpr double kMinTruncationVoxels = 3.0;
constexpr double kTruncationSigmas = 3.0; // of the depth noise

Truncation truncation_of(const FuseParams& params)
{
    return {.least = static_cast<float>(std::max(params.truncation, kMinTruncationVoxels * params.voxel_size)),
            .growth = static_cast<float>(kTruncationSigmas * params.depth_noise)};
}

std::vector<FrameId> frames_with_depth(const Scan& scan)
{
    std::vector<FrameId> frames = scan.frames_in_use();
    std::erase_if(frames, [&](FrameId id) { return !scan.frames[id].has_depth(); });
    if (frames.empty())
        throw ImpossibleError(fmt::format(
            "none of the {} frames of the scan is usable and has depth: there is nothing to fuse", scan.frames.size()));
    return frames;
}

// Block coordinates are bounded; a pose that far away is no pose of this room.
void check_position(const Scan& scan, FrameId id, const FuseParams& params)
{
    const double reach = kMaxBlockCoord * kBlockSide * params.voxel_size -
                         2.0 * (params.max_depth + truncation_of(params).at(static_cast<float>(params.max_depth)));
    const Eigen::Vector3d eye_world = scan.frames[id].camera_from_world.inverse().translation();
    if (eye_world.cwiseAbs().maxCoeff() < reach) return;
    throw InputError(fmt::format(
        "frame {} lies at ({:g}, {:g}, {:g}) m, too far from the origin for a voxel_size of {} m; check the "
        "unit of the poses or import the scan with poses near the origin",
        id, eye_world.x(), eye_world.y(), eye_world.z(), params.voxel_size));
}

DepthView load_view(const Scan& scan, const FrameSource& source, FrameId id, const FuseParams& params)
{
    check_position(scan, id, params);
    const DepthImage depth = source.depth(id);
    const ColorImage color = depth.empty() || !scan.frames[id].has_color() ? ColorImage{} : source.color(id);
    return make_view(
        scan, id, depth, color,
        {params.min_depth, params.max_depth, params.depth_edge, params.min_incidence, truncation_of(params).least});
}

// Throws when `blocks` blocks are more than allowed, and says which voxel size would do: blocks grow with its inverse
// square.
void check_memory(std::size_t blocks, double share_of_frames, const FuseParams& params)
{
    const double gigabytes = static_cast<double>(blocks * sizeof(VoxelBlock)) / kBytesPerGigabyte;
    if (gigabytes <= params.memory_limit) return;
    const double needed = gigabytes / share_of_frames;
    const double fitting = params.voxel_size * std::sqrt(needed / params.memory_limit);
    throw ResourceError(fmt::format("fusing at voxel_size {} m needs {:.1f} GB of voxels after {:.0f} % of the frames, "
                                    "about {:.1f} GB in the end; memory_limit is "
                                    "{} GB: raise it, or take voxel_size {:.3f} m",
                                    params.voxel_size, gigabytes, 100.0 * share_of_frames, needed, params.memory_limit,
                                    std::ceil(fitting * 1e3) / 1e3));
}

std::vector<BlockKey> missing_blocks(const VoxelGrid& grid, const std::vector<std::vector<BlockKey>>& wanted)
{
    std::vector<BlockKey> keys;
    for (const auto& of_view : wanted)
        for (const BlockKey key : of_view)
            if (grid.find(key) == kNoBlock) keys.push_back(key);
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    return keys;
}

VoxelGrid integrate_frames(const Scan& scan, const FrameSource& source, const std::vector<FrameId>& frames,
                           const FuseParams& params)
{
    VoxelGrid grid(params.voxel_size);
    Progress progress("fusing frames", frames.size());
    for (std::size_t begin = 0; begin < frames.size(); begin += kBatch) {
        const std::size_t count = std::min(kBatch, frames.size() - begin);
        std::vector<DepthView> views(count);
        std::vector<std::vector<BlockKey>> wanted(count);
        parallel_for(count, [&](std::size_t i) {
            views[i] = load_view(scan, source, frames[begin + i], params);
            wanted[i] = blocks_near_surface(views[i], grid.block_size(), truncation_of(params));
        });
        const auto keys = missing_blocks(grid, wanted);
        check_memory(grid.size() + keys.size(), static_cast<double>(begin + count) / static_cast<double>(frames.size()),
                     params);
        grid.create(keys);
        integrate(grid, views, truncation_of(params));
        progress.step(count);
    }
    return grid;
}

// What a voxel must weigh to be part of the surface: min_weight, or less where the whole scan weighs little.
double least_weight(const VoxelGrid& grid, const FuseParams& params)
{
    const double typical = typical_surface_weight(grid, truncation_of(params).least);
    const double least = std::min(params.min_weight, params.min_weight_share * typical);
    if (least < params.min_weight)
        log_info(fmt::format("voxels at the surface weigh {:.3g}: those of {:.3g} make surface already, not of "
                             "min_weight {} only",
                             typical, least, params.min_weight));
    return least;
}

Eigen::AlignedBox3f extent(const TriangleMesh& mesh)
{
    Eigen::AlignedBox3f box;
    for (const auto& p : mesh.position)
        box.extend(p);
    return box;
}

void report_cleanup(const std::string& what, const TriangleMesh& mesh, const RemovedComponents& removed)
{
    log_info(fmt::format("{}: {} vertices, {} faces; {} small pieces with {} faces are removed.", what,
                         mesh.position.size(), mesh.face.size(), removed.components, removed.faces));
}

TriangleMesh require_surface(TriangleMesh mesh, const std::string& advice)
{
    if (mesh.face.empty()) throw ImpossibleError("no surface is left: " + advice);
    return mesh;
}

TriangleMesh read_dense_mesh(const ScanImages& images, const FuseParams& params)
{
    const ScanFile& file = images.scan().dense_mesh;
    if (file.name.empty())
        throw InputError("source is 'mesh', but the scan brings no mesh of its own; take 'frames' or 'auto'");
    TriangleMesh mesh = parse_ply(images.bytes(file), file.name);
    const auto report = clean_up(mesh, {.weld_tolerance = 0.0,
                                        .min_component_faces = params.min_component_faces,
                                        .min_component_area = params.min_component_area});
    log_info(
        fmt::format("{}: {} vertices not finite, {} welded, {} split, {} isolated; {} faces degenerate, {} duplicate.",
                    file.name, report.non_finite_vertices, report.welded_vertices, report.split_vertices,
                    report.isolated_vertices, report.degenerate_faces, report.duplicate_faces));
    report_cleanup(file.name, mesh, report.small);
    warn_about_extent(extent(mesh), params.plausible_extent);
    return require_surface(std::move(mesh),
                           file.name + " has no piece as large as min_component_faces and min_component_area ask for");
}

} // namespace

TriangleMesh fuse_frames(const Scan& scan, const FrameSource& source, const FuseParams& params)
{
    const auto frames = frames_with_depth(scan);
    const VoxelGrid grid = integrate_frames(scan, source, frames, params);
    TriangleMesh mesh = extract_surface(grid, least_weight(grid, params));
    const auto removed =
        drop_small_components(mesh, static_cast<std::size_t>(params.min_component_faces), params.min_component_area);
    split_touching_fans(mesh);
    remove_isolated_vertices(mesh);
    report_cleanup(fmt::format("{} frames, {} blocks of voxels", frames.size(), grid.size()), mesh, removed);
    warn_about_extent(extent(mesh), params.plausible_extent);
    return require_surface(std::move(mesh),
                           fmt::format("{} frames were fused; check the depth unit of the scan against min_depth {} m "
                                       "and max_depth {} m, or keep smaller pieces than min_component_faces {}",
                                       frames.size(), params.min_depth, params.max_depth, params.min_component_faces));
}

TriangleMesh fuse(const ScanImages& images, const FuseParams& params)
{
    const bool has_mesh = !images.scan().dense_mesh.name.empty();
    if (params.source == FuseSource::Mesh || (params.source == FuseSource::Auto && has_mesh))
        return read_dense_mesh(images, params);
    const FrameSource source{[&](FrameId id) { return images.depth(id); },
                             [&](FrameId id) { return images.color(id); }};
    return fuse_frames(images.scan(), source, params);
}

} // namespace quoin
