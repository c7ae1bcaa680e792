#include "compare/plane_match.h"

#include "metrics/surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace quoin {
namespace {

constexpr std::size_t kMatchSamples = 50'000;
constexpr double kMatchReach = 0.1;                      // [m] between two surfaces of one plane
constexpr double kLargestAngle = std::numbers::pi / 6.0; // [rad] between their normals

struct PlaneSize {
    double area = 0.0;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
};

std::vector<PlaneSize> plane_sizes(const PlaneMesh& mesh)
{
    std::vector<PlaneSize> sizes(mesh.plane.size());
    for (FaceId f = 0; f < mesh.mesh.face.size(); ++f) {
        const double area = face_area(mesh.mesh, f);
        PlaneSize& size = sizes[mesh.face_plane[f]];
        size.area += area;
        size.center += area / 3.0 * (corner(mesh.mesh, f, 0) + corner(mesh.mesh, f, 1) + corner(mesh.mesh, f, 2));
    }
    for (auto& size : sizes)
        if (size.area > 0.0) size.center /= size.area;
    return sizes;
}

using Votes = std::map<std::pair<PlaneId, PlaneId>, std::size_t>;

// Samples of the first surface by the plane that they are on and the nearest plane of the second.
Votes count_votes(const PlaneMesh& first, const PlaneMesh& second)
{
    Votes votes;
    if (first.mesh.face.empty() || second.mesh.face.empty()) return votes;
    const NearestItem surface(second.mesh);
    for (const auto& sample : sample_surface(first.mesh, kMatchSamples)) {
        const auto near = surface.find(sample.position, kMatchReach);
        if (!near) continue;
        const PlaneId a = first.face_plane[sample.face], b = second.face_plane[near->item];
        if (first.plane[a].normal.dot(second.plane[b].normal) > std::cos(kLargestAngle)) ++votes[{a, b}];
    }
    return votes;
}

PlanePair make_pair(const PlaneMesh& first, const PlaneMesh& second, PlaneId a, PlaneId b,
                    const Eigen::Vector3d& center)
{
    const Eigen::Vector3d &n = first.plane[a].normal, &m = second.plane[b].normal;
    return {a, b, std::atan2(n.cross(m).norm(), n.dot(m)), std::abs(second.plane[b].signed_distance(center))};
}

} // namespace

PlaneMatches match_planes(const PlaneMesh& first, const PlaneMesh& second)
{
    const auto sizes_first = plane_sizes(first), sizes_second = plane_sizes(second);
    const Votes votes = count_votes(first, second);
    std::vector<std::pair<std::size_t, std::pair<PlaneId, PlaneId>>> ranked;
    for (const auto& [pair, count] : votes)
        ranked.emplace_back(count, pair);
    std::ranges::stable_sort(ranked, std::greater(), [](const auto& r) { return r.first; });

    PlaneMatches matches;
    std::vector<bool> has_first(first.plane.size(), false), has_second(second.plane.size(), false);
    for (const auto& [count, pair] : ranked) {
        const auto [a, b] = pair;
        if (has_first[a] || has_second[b]) continue;
        has_first[a] = has_second[b] = true;
        matches.pairs.push_back(make_pair(first, second, a, b, sizes_first[a].center));
    }
    std::ranges::sort(matches.pairs, {}, &PlanePair::first);
    const auto add_rest = [](const std::vector<bool>& has, const std::vector<PlaneSize>& sizes, auto& ids,
                             double& area) {
        for (PlaneId p = 0; p < has.size(); ++p) {
            if (has[p] || sizes[p].area <= 0.0) continue;
            ids.push_back(p);
            area += sizes[p].area;
        }
    };
    add_rest(has_first, sizes_first, matches.only_first, matches.area_only_first);
    add_rest(has_second, sizes_second, matches.only_second, matches.area_only_second);
    return matches;
}

} // namespace quoin
