#include "metrics/nearest.h"

#include "base/error.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <embree3/rtcore.h>

namespace quoin {
namespace {

using Eigen::Vector3d;

} // namespace

// Segments are triangles with two equal corners.
struct NearestItem::Tree {
    std::vector<std::array<Vector3d, 3>> item;
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    explicit Tree(std::vector<std::array<Vector3d, 3>> items)
        : item(std::move(items)), device(rtcNewDevice("threads=1"))
    {
        if (!device) throw ResourceError("Embree cannot make a device; is the machine out of memory?");
        scene = rtcNewScene(device);
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(item.size()));
        rtcSetGeometryUserData(geometry, this);
        rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
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

    static void bounds(const RTCBoundsFunctionArguments* args)
    {
        const auto& corner = static_cast<const Tree*>(args->geometryUserPtr)->item[args->primID];
        const Vector3d low = corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]),
                       high = corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]);
        const auto down = [](double v) { return std::nextafter(static_cast<float>(v), -INFINITY); };
        const auto up = [](double v) { return std::nextafter(static_cast<float>(v), INFINITY); };
        *args->bounds_o = {down(low.x()), down(low.y()), down(low.z()), 0.0f,
                           up(high.x()),  up(high.y()),  up(high.z()),  0.0f};
    }
};

namespace {

struct Search {
    const std::vector<std::array<Vector3d, 3>>& item;
    Vector3d point;
    double best; // squared [m^2]
    bool found = false;
    NearestPoint nearest{};
};

bool visit(RTCPointQueryFunctionArguments* args)
{
    auto& search = *static_cast<Search*>(args->userPtr);
    const Vector3d near = nearest_on_triangle(search.point, search.item[args->primID]);
    const double square = (near - search.point).squaredNorm();
    if (square > search.best || (square == search.best && search.found && args->primID > search.nearest.item))
        return false;
    search.best = square;
    search.found = true;
    search.nearest = {args->primID, near, std::sqrt(square)};
    // A hair wider than the distance, so that rounding hides no item at the same distance.
    args->query->radius = static_cast<float>(std::sqrt(square) * (1.0 + 1e-5)) + 1e-7f;
    return true;
}

} // namespace

Vector3d nearest_on_segment(const Vector3d& point, const Segment3& segment)
{
    const Vector3d way = segment[1] - segment[0];
    const double square = way.squaredNorm();
    const double t = square > 0.0 ? std::clamp(way.dot(point - segment[0]) / square, 0.0, 1.0) : 0.0;
    return segment[0] + t * way;
}

Vector3d nearest_on_triangle(const Vector3d& point, const std::array<Vector3d, 3>& corner)
{
    const Vector3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const double square = normal.squaredNorm();
    if (square > 0.0) {
        Vector3d on_plane = point - normal * (normal.dot(point - corner[0]) / square);
        const auto inside = [&](std::size_t k) {
            return normal.dot((corner[(k + 1) % 3] - corner[k]).cross(on_plane - corner[k])) >= 0.0;
        };
        if (inside(0) && inside(1) && inside(2)) return on_plane;
    }
    Vector3d best = nearest_on_segment(point, {corner[0], corner[1]});
    for (std::size_t k = 1; k < 3; ++k) {
        const Vector3d near = nearest_on_segment(point, {corner[k], corner[(k + 1) % 3]});
        if ((near - point).squaredNorm() < (best - point).squaredNorm()) best = near;
    }
    return best;
}

NearestItem::NearestItem(const TriangleMesh& mesh)
{
    std::vector<std::array<Vector3d, 3>> items;
    for (FaceId f = 0; f < mesh.face.size(); ++f)
        items.push_back({corner(mesh, f, 0), corner(mesh, f, 1), corner(mesh, f, 2)});
    tree_ = std::make_shared<const Tree>(std::move(items));
}

NearestItem::NearestItem(const std::vector<Segment3>& segments)
{
    std::vector<std::array<Vector3d, 3>> items;
    for (const Segment3& s : segments)
        items.push_back({s[0], s[1], s[1]});
    tree_ = std::make_shared<const Tree>(std::move(items));
}

std::optional<NearestPoint> NearestItem::find(const Vector3d& point, double reach) const
{
    Search search{tree_->item, point, reach * reach};
    RTCPointQuery query{};
    query.x = static_cast<float>(point.x()), query.y = static_cast<float>(point.y()),
    query.z = static_cast<float>(point.z());
    query.radius = static_cast<float>(reach);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(tree_->scene, &query, &context, visit, &search);
    if (!search.found) return std::nullopt;
    return search.nearest;
}

} // namespace quoin
