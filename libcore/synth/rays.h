// Rays against the triangles of a room (Embree stays in the .cpp).
#pragma once

#include "synth/room.h"

#include <array>
#include <memory>
#include <span>

namespace quoin {

// A triangle with its place in the texture of its surface. Surfaces count planar ones first, then curved ones.
struct Facet {
    std::array<Eigen::Vector3d, 3> corner; // world [m], counter-clockwise from the free side
    std::array<Eigen::Vector2d, 3> uv;     // [m]
    std::uint32_t surface = 0;

    Eigen::Vector3d area_vector() const { return 0.5 * (corner[1] - corner[0]).cross(corner[2] - corner[0]); }
};
std::vector<Facet> facets_of(const Room& room);

inline constexpr std::uint32_t kNoFacet = 0xffffffffu;
struct RayHit {
    std::uint32_t facet = kNoFacet;
    float distance = 0.0f; // in lengths of the direction
};

// Answers do not depend on threads: the tree is built by one, and queries share nothing.
class RayScene {
public:
    explicit RayScene(const std::vector<Facet>& facets);
    RayHit cast(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const;
    // Many rays from one origin; neighbours in the list should point in similar directions.
    void cast(const Eigen::Vector3f& origin, std::span<const Eigen::Vector3f> directions, std::span<RayHit> hits) const;
    // Does something lie between two points? Surfaces that hold an end do not count.
    bool blocked(const Eigen::Vector3f& from, const Eigen::Vector3f& to) const;

private:
    struct Tree;
    std::shared_ptr<const Tree> tree_;
};

} // namespace quoin
