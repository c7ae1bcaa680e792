// Zones too small to tell from their surroundings.
#include "base/parallel.h"
#include "mesh/adjacency.h"
#include "simplify/zones.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

constexpr std::size_t kIslandGrain = 1 << 14;

} // namespace

// Of every zone the one that is behind all of its border; kNoPlane if that is not one.
std::vector<PlaneId> Zones::surrounding_zones() const
{
    constexpr PlaneId kMany = kNoPlane - 1;
    std::vector<PlaneId> behind(size(), kNoPlane);
    const auto note = [&](PlaneId zone, PlaneId other) {
        behind[zone] = behind[zone] == kNoPlane || behind[zone] == other ? other : kMany;
    };
    for (const std::uint32_t h : border_) {
        const PlaneId here = mesh_.face_plane[h / 3];
        if (opposite_[h] == kBorderEdge) {
            behind[here] = kMany;
            continue;
        }
        const PlaneId there = mesh_.face_plane[opposite_[h] / 3];
        note(here, there);
        note(there, here);
    }
    std::ranges::replace(behind, kMany, kNoPlane);
    return behind;
}

// Drops those whose own border reaches farther.
void Zones::keep_small(std::vector<PlaneId>& surrounding, double diameter) const
{
    std::vector<Eigen::AlignedBox3f> extent(size());
    const auto extend = [&](PlaneId zone, std::uint32_t h) {
        if (surrounding[zone] == kNoPlane) return;
        for (const VertexId v : ends(h))
            extent[zone].extend(mesh_.mesh.position[v]);
    };
    for (const std::uint32_t h : border_) {
        extend(mesh_.face_plane[h / 3], h);
        if (opposite_[h] != kBorderEdge) extend(mesh_.face_plane[opposite_[h] / 3], h);
    }
    for (PlaneId z = 0; z < size(); ++z)
        if (surrounding[z] != kNoPlane && extent[z].diagonal().norm() > diameter) surrounding[z] = kNoPlane;
}

// Drops those with a vertex farther from the plane around them. faces: of those that are left, at least.
void Zones::keep_low(std::vector<PlaneId>& surrounding, const std::vector<FaceId>& faces, double height) const
{
    for (const FaceId f : faces)
        for (int k = 0; k < 3; ++k) {
            PlaneId& around = surrounding[mesh_.face_plane[f]];
            if (around != kNoPlane && std::abs(plane(around).signed_distance(corner(mesh_.mesh, f, k))) > height)
                around = kNoPlane;
        }
}

// Gives faces to the zones around them, but for those of zones that have such a zone within them. Are there any?
bool Zones::absorb(const std::vector<PlaneId>& surrounding, const std::vector<FaceId>& faces)
{
    bool changed = false;
    for (const FaceId f : faces) {
        PlaneId& zone = mesh_.face_plane[f];
        const PlaneId around = surrounding[zone];
        if (around == kNoPlane || surrounding[around] != kNoPlane) continue;
        pending_[zone] = 0; // no face is left
        --faces_[zone];
        ++faces_[around];
        zone = around;
        changed = true;
    }
    return changed;
}

void Zones::absorb_islands(const SimplifyParams& params)
{
    const double height = params.max_inner_error > 0.0 ? params.max_inner_error : params.max_open_error;
    for (bool changed = true; changed;) { // one may have been within another
        auto surrounding = surrounding_zones();
        keep_small(surrounding, 2.0 * params.max_open_error);
        const auto faces = parallel_select<FaceId>(mesh_.face_plane.size(), kIslandGrain, [&](std::size_t f) {
            return surrounding[mesh_.face_plane[f]] != kNoPlane;
        });
        keep_low(surrounding, faces, height);
        changed = absorb(surrounding, faces);
        std::erase_if(border_, [&](std::uint32_t h) {
            const std::uint32_t o = opposite_[h];
            return o != kBorderEdge && mesh_.face_plane[h / 3] == mesh_.face_plane[o / 3];
        });
    }
    mesh_.vertex_class = classify_vertices(mesh_.mesh, mesh_.face_plane, opposite_);
}

} // namespace quoin
