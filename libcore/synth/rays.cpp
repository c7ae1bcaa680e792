#include "synth/rays.h"

#include "base/error.h"

#include <algorithm>
#include <embree3/rtcore.h>
#include <limits>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr float kEndGap = 1e-4f; // of a shadow ray, so that it does not meet the surfaces of its ends
constexpr int kPacket = 8;

void add_planar(std::vector<Facet>& facets, const PlanarSurface& surface, std::uint32_t id)
{
    for (const Polygon& piece : surface.pieces)
        for (std::size_t i = 2; i < piece.size(); ++i) {
            const std::array corner{piece[0], piece[i - 1], piece[i]};
            facets.push_back({corner, {surface.uv(corner[0]), surface.uv(corner[1]), surface.uv(corner[2])}, id});
        }
}

void add_curved(std::vector<Facet>& facets, const LatheSurface& lathe, std::uint32_t id)
{
    for (std::size_t ring = 0; ring + 1 < lathe.profile.size(); ++ring)
        for (int s = 0; s < lathe.segments; ++s) {
            const auto add = [&](const std::array<std::array<std::size_t, 2>, 3>& at) {
                Facet facet;
                facet.surface = id;
                for (std::size_t k = 0; k < 3; ++k) {
                    facet.corner[k] = lathe.corner(static_cast<int>(at[k][0]), at[k][1]);
                    facet.uv[k] = lathe.corner_uv(static_cast<int>(at[k][0]), at[k][1]);
                }
                if (facet.area_vector().norm() > 0.0) facets.push_back(facet);
            };
            const auto a = static_cast<std::size_t>(s), b = a + 1;
            if (lathe.profile[ring + 1].x() > 0.0) add({{{a, ring}, {a, ring + 1}, {b, ring + 1}}});
            if (lathe.profile[ring].x() > 0.0) add({{{a, ring}, {b, ring + 1}, {b, ring}}});
        }
}

} // namespace

std::vector<Facet> facets_of(const Room& room)
{
    std::vector<Facet> facets;
    std::uint32_t id = 0;
    for (const PlanarSurface& surface : room.planar)
        add_planar(facets, surface, id++);
    for (const LatheSurface& lathe : room.curved)
        add_curved(facets, lathe, id++);
    return facets;
}

struct RayScene::Tree {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    explicit Tree(const std::vector<Facet>& facets) : device(rtcNewDevice("threads=1"))
    {
        if (!device) throw ResourceError("Embree cannot make a device; is the machine out of memory?");
        scene = rtcNewScene(device);
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * facets.size()));
        auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), facets.size()));
        for (std::size_t i = 0; i < 3 * facets.size(); ++i) {
            const Vector3f p = facets[i / 3].corner[i % 3].cast<float>();
            std::copy(p.data(), p.data() + 3, points + 3 * i);
            indices[i] = static_cast<std::uint32_t>(i);
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene);
    }
    ~Tree()
    {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
    Tree(const Tree&) = delete;
    Tree& operator=(const Tree&) = delete;
};

RayScene::RayScene(const std::vector<Facet>& facets) : tree_(std::make_shared<const Tree>(facets)) {}

RayHit RayScene::cast(const Vector3f& origin, const Vector3f& direction) const
{
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit ray{};
    ray.ray.org_x = origin.x(), ray.ray.org_y = origin.y(), ray.ray.org_z = origin.z();
    ray.ray.dir_x = direction.x(), ray.ray.dir_y = direction.y(), ray.ray.dir_z = direction.z();
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = ~0u;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(tree_->scene, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {ray.hit.primID, ray.ray.tfar};
}

void RayScene::cast(const Vector3f& origin, std::span<const Vector3f> directions, std::span<RayHit> hits) const
{
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (std::size_t begin = 0; begin < directions.size(); begin += kPacket) {
        const int count = static_cast<int>(std::min<std::size_t>(kPacket, directions.size() - begin));
        alignas(32) int valid[kPacket]{};
        alignas(32) RTCRayHit8 packet{};
        for (int k = 0; k < count; ++k) {
            const Vector3f& d = directions[begin + static_cast<std::size_t>(k)];
            valid[k] = -1;
            packet.ray.org_x[k] = origin.x(), packet.ray.org_y[k] = origin.y(), packet.ray.org_z[k] = origin.z();
            packet.ray.dir_x[k] = d.x(), packet.ray.dir_y[k] = d.y(), packet.ray.dir_z[k] = d.z();
            packet.ray.tfar[k] = std::numeric_limits<float>::infinity();
            packet.ray.mask[k] = ~0u;
            packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect8(valid, tree_->scene, &context, &packet);
        for (int k = 0; k < count; ++k) {
            const bool hit = packet.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
            hits[begin + static_cast<std::size_t>(k)] =
                hit ? RayHit{packet.hit.primID[k], packet.ray.tfar[k]} : RayHit{};
        }
    }
}

bool RayScene::blocked(const Vector3f& from, const Vector3f& to) const
{
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    const Vector3f way = to - from;
    const float gap = kEndGap / std::max(way.norm(), 2.0f * kEndGap);
    RTCRay ray{};
    ray.org_x = from.x(), ray.org_y = from.y(), ray.org_z = from.z();
    ray.dir_x = way.x(), ray.dir_y = way.y(), ray.dir_z = way.z();
    ray.tnear = gap;
    ray.tfar = 1.0f - gap;
    ray.mask = ~0u;
    rtcOccluded1(tree_->scene, &context, &ray);
    return ray.tfar < 0.0f;
}

} // namespace quoin
