#include "bake/density.h"

#include "base/parallel.h"
#include "render/rasterize.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace quoin {
namespace {

constexpr int kLevel = 2;          // visibility is measured at a quarter of the resolution
constexpr double kGoodPart = 0.25; // of the largest area that a view sees of a chart
constexpr std::size_t kBestViews = 3;

struct Footprint {
    std::uint32_t chart = 0;
    double area = 0.0;       // seen [m^2]
    double resolution = 0.0; // mean over that area [px/m]
};

struct View {
    Camera camera; // at kLevel
    Rigid camera_from_world;
};

std::vector<Footprint> footprints(const View& view, const PlaneMesh& planes,
                                  const std::vector<std::uint32_t>& face_chart, double min_facing)
{
    const Visibility visibility = rasterize(planes.mesh, view.camera, view.camera_from_world);
    std::vector<Footprint> seen;
    std::vector<std::uint32_t> slot(*std::ranges::max_element(face_chart) + 1, kNoFace);
    const double full_resolution = view.camera.fx * (1 << kLevel);
    for (int y = 0; y < view.camera.height; ++y)
        for (int x = 0; x < view.camera.width; ++x) {
            const FaceId f = visibility.face.at(x, y);
            if (f == kNoFace) continue;
            const double z = visibility.depth.at(x, y);
            const Eigen::Vector3d ray = view.camera.ray({x, y});
            const double facing =
                -(view.camera_from_world.linear() * face_normal(planes.mesh, f)).dot(ray) / ray.norm();
            if (facing < min_facing) continue;
            auto& index = slot[face_chart[f]];
            if (index == kNoFace) {
                index = static_cast<std::uint32_t>(seen.size());
                seen.push_back({face_chart[f]});
            }
            const double area = z * z / (view.camera.fx * view.camera.fy * facing);
            seen[index].area += area;
            seen[index].resolution += area * full_resolution * std::sqrt(facing) / z;
        }
    for (auto& footprint : seen)
        footprint.resolution /= footprint.area;
    return seen;
}

std::vector<std::vector<Footprint>> footprints_of_charts(const std::vector<Chart>& charts, const PlaneMesh& planes,
                                                         const Alignment& alignment, double min_facing)
{
    std::vector<std::uint32_t> face_chart(planes.mesh.face.size());
    for (std::uint32_t c = 0; c < charts.size(); ++c)
        for (const FaceId f : charts[c].face)
            face_chart[f] = c;
    const Camera camera = alignment.color.at_level(kLevel);
    std::vector<std::vector<Footprint>> of_view(alignment.camera_from_world.size());
    parallel_for(of_view.size(), [&](std::size_t k) {
        of_view[k] = footprints({camera, alignment.color_from_world(k)}, planes, face_chart, min_facing);
    });
    std::vector<std::vector<Footprint>> of_chart(charts.size());
    for (const auto& view : of_view)
        for (const auto& footprint : view)
            of_chart[footprint.chart].push_back(footprint);
    return of_chart;
}

double best_resolution(const std::vector<Footprint>& seen)
{
    double largest = 0.0;
    for (const auto& footprint : seen)
        largest = std::max(largest, footprint.area);
    std::vector<double> resolution;
    for (const auto& footprint : seen)
        if (footprint.area >= kGoodPart * largest) resolution.push_back(footprint.resolution);
    std::ranges::sort(resolution, std::greater{});
    return resolution[std::min(resolution.size(), kBestViews) / 2];
}

} // namespace

void set_densities(std::vector<Chart>& charts, const PlaneMesh& planes, const Alignment& alignment,
                   const BakeTextureParams& params)
{
    const double min_facing = std::cos(params.max_view_angle * std::numbers::pi / 180.0);
    const auto seen = footprints_of_charts(charts, planes, alignment, min_facing);
    for (std::size_t c = 0; c < charts.size(); ++c)
        charts[c].density = seen[c].empty()
                                ? params.density
                                : std::clamp(params.supersampling * best_resolution(seen[c]), params.min_density,
                                             std::max(params.min_density, params.max_density));
}

} // namespace quoin
