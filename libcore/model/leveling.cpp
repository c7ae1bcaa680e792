#include "model/leveling.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace quoin {
namespace {

// Planes as the model's faces see them: area and mean position, normals of the planes.
struct Facet {
    Plane plane;
    double area = 0.0;                                  // [m^2]
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero(); // world [m]
};

std::vector<Facet> facets_of(const PlaneMesh& planes)
{
    std::vector<Facet> facets(planes.plane.size());
    for (std::size_t p = 0; p < facets.size(); ++p)
        facets[p].plane = planes.plane[p];
    for (FaceId f = 0; f < planes.mesh.face.size(); ++f) {
        Facet& facet = facets[planes.face_plane[f]];
        const double area = face_area(planes.mesh, f);
        facet.area += area;
        for (int k = 0; k < 3; ++k)
            facet.centroid += area / 3.0 * corner(planes.mesh, f, k);
    }
    for (auto& facet : facets)
        if (facet.area > 0.0) facet.centroid /= facet.area;
    return facets;
}

Eigen::Vector3d mean_up(const std::vector<Rigid>& camera_from_world)
{
    Eigen::Vector3d up = Eigen::Vector3d::Zero();
    for (const auto& pose : camera_from_world)
        up -= pose.linear().row(1).transpose(); // the image's y axis points down
    return up;
}

// The area-weighted mean normal of the planes within `max_tilt` of `up`, floors and ceilings alike, narrowed round by
// round, so that sloping things (cushions, open laptops) drop out.
Eigen::Vector3d snap_up(const std::vector<Facet>& facets, Eigen::Vector3d up, double max_tilt)
{
    constexpr int kRounds = 4;
    for (int round = 0; round < kRounds; ++round, max_tilt *= 0.5) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const auto& facet : facets) {
            const double cosine = facet.plane.normal.dot(up);
            if (std::abs(cosine) >= std::cos(max_tilt)) sum += std::copysign(facet.area, cosine) * facet.plane.normal;
        }
        if (sum.isZero()) break;
        up = sum.normalized();
    }
    return up;
}

std::optional<PlaneId> find_floor(const std::vector<Facet>& facets, const Eigen::Vector3d& up, double max_tilt,
                                  double least_part)
{
    const auto faces_up = [&](const Facet& facet) { return facet.plane.normal.dot(up) >= std::cos(max_tilt); };
    double largest = 0.0;
    for (const auto& facet : facets)
        if (faces_up(facet)) largest = std::max(largest, facet.area);
    std::optional<PlaneId> floor;
    double lowest = std::numeric_limits<double>::infinity();
    for (PlaneId p = 0; p < facets.size(); ++p) {
        const double height = facets[p].centroid.dot(up);
        if (!faces_up(facets[p]) || facets[p].area == 0.0 || facets[p].area < least_part * largest || height >= lowest)
            continue;
        lowest = height;
        floor = p;
    }
    return floor;
}

// Angle of the walls about the vertical [rad]: the mean direction of their normals, counted modulo a right angle.
double wall_angle(const std::vector<Facet>& facets, const Eigen::Matrix3d& level_from_world, double max_tilt)
{
    std::complex<double> sum = 0.0;
    for (const auto& facet : facets) {
        const Eigen::Vector3d n = level_from_world * facet.plane.normal;
        if (std::abs(n.y()) > std::sin(max_tilt)) continue;
        sum += std::polar(facet.area, 4.0 * std::atan2(n.z(), n.x()));
    }
    return std::arg(sum) / 4.0;
}

Eigen::Vector3d ground_point(const TriangleMesh& mesh, const Eigen::Matrix3d& model_from_world,
                             std::optional<double> floor_height)
{
    Eigen::AlignedBox3d box;
    for (const auto& p : mesh.position)
        box.extend(Eigen::Vector3d(model_from_world * p.cast<double>()));
    return {box.center().x(), floor_height.value_or(box.min().y()), box.center().z()};
}

} // namespace

Leveling find_level(const TriangleMesh& mesh, const PlaneMesh* planes, const std::vector<Rigid>& camera_from_world,
                    const ExportParams& params)
{
    const double max_tilt = params.max_tilt * std::numbers::pi / 180.0;
    Eigen::Vector3d up = mean_up(camera_from_world);
    up = up.norm() > std::numeric_limits<double>::epsilon() ? Eigen::Vector3d(up.normalized())
                                                            : Eigen::Vector3d::UnitY();
    const std::vector<Facet> facets = planes ? facets_of(*planes) : std::vector<Facet>{};
    up = snap_up(facets, up, max_tilt);

    Leveling level;
    Eigen::Matrix3d rotation = Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitY()).toRotationMatrix();
    if (params.align_walls)
        rotation =
            Eigen::AngleAxisd(wall_angle(facets, rotation, max_tilt), Eigen::Vector3d::UnitY()).toRotationMatrix() *
            rotation;
    level.floor = find_floor(facets, up, max_tilt, params.floor_area);
    const auto floor_height = level.floor ? std::optional(facets[*level.floor].centroid.dot(up)) : std::nullopt;
    level.model_from_world.linear() = rotation;
    level.model_from_world.translation() = -ground_point(mesh, rotation, floor_height);
    return level;
}

} // namespace quoin
