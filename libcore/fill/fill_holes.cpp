#include "fill/fill_holes.h"

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "fill/free_space.h"
#include "fill/patch.h"
#include "fill/pockets.h"
#include "fill/trim.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <unordered_map>

namespace quoin {
namespace {

using Eigen::Vector3d;

void check(const FillHolesInput& input)
{
    const std::size_t poses = input.alignment.camera_from_world.size(), count = input.keyframes.frame.size();
    if (poses != count)
        throw InputError(fmt::format("poses in the alignment, one per keyframe: found {}, expected {}; give the "
                                     "artifacts of one pipeline run",
                                     poses, count));
    const std::size_t frames = input.images.scan().frames.size();
    for (const FrameId id : input.keyframes.frame)
        if (id >= frames) throw InputError(fmt::format("keyframe {} is not in the scan of {} frames", id, frames));
}

double area_of(const std::array<Vector3d, 3>& c) { return (c[1] - c[0]).cross(c[2] - c[0]).norm() / 2.0; }

double area_of(const PlaneMesh& mesh, const Patch& patch)
{
    double area = 0.0;
    for (const Face& face : patch.face)
        area += area_of(corners_of(mesh, patch, face));
    return area;
}

// The middles of n x n equal triangles that make up a face.
void add_points(const std::array<Vector3d, 3>& c, double distance, std::vector<SurfacePoint>& points)
{
    constexpr int kMost = 100; // along a side
    const double longest = std::max({(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()});
    const int n = std::clamp(static_cast<int>(std::ceil(longest / distance)), 1, kMost);
    const double share = area_of(c) / (static_cast<double>(n) * n);
    const auto add = [&](double u, double v) {
        points.push_back({c[0] + (u * (c[1] - c[0]) + v * (c[2] - c[0])) / n, share});
    };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n - i; ++j) {
            add(i + 1.0 / 3.0, j + 1.0 / 3.0);
            if (j + 1 < n - i) add(i + 2.0 / 3.0, j + 2.0 / 3.0);
        }
}

using Patches = std::vector<std::optional<Patch>>;

// How many holes had which fate.
struct Outcome {
    std::size_t loops = 0, large = 0, open = 0, closed = 0;
    double area = 0.0; // closed [m^2]
};

// Loops as a whole first; behind them, in the order of the others, what closes their bays.
Patches propose_all(const PlaneMesh& mesh, const std::vector<BorderLoop>& loops, const FillHolesParams& params)
{
    const Proposer proposer(mesh, loops, params);
    Patches patches(loops.size());
    std::vector<std::vector<Patch>> bays(loops.size());
    parallel_for(loops.size(), [&](std::size_t i) {
        patches[i] = proposer.propose(loops[i]);
        if (!patches[i]) bays[i] = close_pockets(mesh, loops[i], proposer, params);
    });
    for (auto& list : bays)
        std::ranges::move(list, std::back_inserter(patches));
    return patches;
}

// A face without height has no normal and no texture.
bool has_flat_face(const PlaneMesh& mesh, const Patch& patch)
{
    constexpr double kLeastHeight = 1e-6; // [m]
    return std::ranges::any_of(patch.face, [&](const Face& face) {
        const auto c = corners_of(mesh, patch, face);
        const double longest = std::max({(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()});
        return 2.0 * area_of(c) <= kLeastHeight * longest;
    });
}

void drop_flat_and_large(const PlaneMesh& mesh, double max_area, Patches& patches, Outcome& outcome)
{
    for (auto& patch : patches) {
        if (patch && has_flat_face(mesh, *patch)) patch.reset();
        if (!patch) continue;
        if (area_of(mesh, *patch) <= max_area) continue;
        patch.reset();
        ++outcome.large;
    }
}

void drop_open(const FillHolesInput& input, const FillHolesParams& params, Patches& patches, Outcome& outcome)
{
    std::vector<SurfacePoint> points;
    std::vector<std::size_t> end;
    for (const auto& patch : patches) {
        if (patch)
            for (const Face& face : patch->face)
                add_points(corners_of(input.planes, *patch, face), params.sample_distance, points);
        end.push_back(points.size());
    }
    const auto rays = rays_through(points, input, params);
    for (std::size_t i = 0, p = 0; i < patches.size(); ++i) {
        double area = 0.0, open = 0.0;
        for (; p < end[i]; ++p) {
            area += points[p].area;
            if (rays[p] >= static_cast<std::uint32_t>(params.min_views)) open += points[p].area;
        }
        if (!patches[i] || open <= params.max_open * area) continue;
        patches[i].reset();
        ++outcome.open;
    }
}

// Faces on every edge, so that none gets a third.
class EdgeCount {
public:
    explicit EdgeCount(const std::vector<Face>& faces) { add(faces, +1); }

    // False, and nothing added, when an edge would have more than two faces.
    bool try_add(const std::vector<Face>& faces)
    {
        add(faces, +1);
        const bool fits = std::ranges::all_of(faces, [&](const Face& f) {
            return count_[key(f[0], f[1])] <= 2 && count_[key(f[1], f[2])] <= 2 && count_[key(f[2], f[0])] <= 2;
        });
        if (!fits) add(faces, -1);
        return fits;
    }

private:
    static std::uint64_t key(VertexId a, VertexId b)
    {
        const auto [low, high] = std::minmax(a, b);
        return std::uint64_t{low} << 32 | high;
    }
    void add(const std::vector<Face>& faces, int sign)
    {
        for (const Face& f : faces)
            for (std::size_t k = 0; k < 3; ++k)
                count_[key(f[k], f[(k + 1) % 3])] += sign;
    }
    std::unordered_map<std::uint64_t, int> count_;
};

// The patch's faces, with its new vertices behind all that the mesh has by now.
std::vector<Face> renumbered(const Patch& patch, std::size_t known, std::size_t now)
{
    std::vector<Face> faces = patch.face;
    for (Face& face : faces)
        for (VertexId& v : face)
            if (v >= known) v += static_cast<VertexId>(now - known);
    return faces;
}

// Colours and normals of new vertices, where the mesh has them, are those of a neighbour.
void append(const Patch& patch, const std::vector<Face>& faces, PlaneMesh& mesh)
{
    const VertexId neighbour = std::ranges::min(faces[0]);
    for (const auto& p : patch.vertex) {
        mesh.mesh.position.push_back(p.cast<float>());
        if (!mesh.mesh.color.empty()) mesh.mesh.color.push_back(mesh.mesh.color[neighbour]);
        if (!mesh.mesh.normal.empty()) mesh.mesh.normal.push_back(mesh.mesh.normal[neighbour]);
    }
    mesh.mesh.face.insert(mesh.mesh.face.end(), faces.begin(), faces.end());
    mesh.face_plane.insert(mesh.face_plane.end(), patch.plane.begin(), patch.plane.end());
}

Filled<PlaneMesh> with_patches(const PlaneMesh& planes, const Patches& patches, const FillHolesParams& params,
                               Outcome& outcome)
{
    PlaneMesh filled = planes;
    EdgeCount edges(planes.mesh.face);
    for (const auto& patch : patches) {
        if (!patch) continue;
        const auto faces = renumbered(*patch, planes.mesh.position.size(), filled.mesh.position.size());
        if (!edges.try_add(faces)) continue;
        append(*patch, faces, filled);
        ++outcome.closed;
    }
    const auto known = static_cast<FaceId>(planes.mesh.face.size());
    trim_patches(filled, known, params.plane_distance);
    for (FaceId f = known; f < filled.mesh.face.size(); ++f)
        outcome.area += face_area(filled.mesh, f);
    filled.vertex_class = classify_vertices(filled.mesh, filled.face_plane);
    std::vector<std::uint8_t> marks(planes.mesh.face.size(), 0);
    marks.resize(filled.mesh.face.size(), 1);
    return {std::move(filled), std::move(marks)};
}

void report(const Outcome& outcome)
{
    log_info(fmt::format("closed {} holes and bays of {} borders, {:.2f} m^2; rays pass through {} others, and {} are "
                         "too large",
                         outcome.closed, outcome.loops, outcome.area, outcome.open, outcome.large));
}

} // namespace

Filled<PlaneMesh> fill_holes(const FillHolesInput& input, const FillHolesParams& params)
{
    check(input);
    if (!params.enabled) return {input.planes, std::vector<std::uint8_t>(input.planes.mesh.face.size(), 0)};
    const auto loops = border_loops(input.planes);
    Patches patches = propose_all(input.planes, loops, params);
    Outcome outcome;
    outcome.loops = loops.size();
    drop_flat_and_large(input.planes, params.max_area, patches, outcome);
    drop_open(input, params, patches, outcome);
    Filled<PlaneMesh> filled = with_patches(input.planes, patches, params, outcome);
    report(outcome);
    return filled;
}

} // namespace quoin
