#include "base/parallel.h"
#include "compare/plane_match.h"
#include "compare/schemas.h"
#include "geometry/units.h"
#include "image/image_io.h"
#include "metrics/image_quality.h"
#include "metrics/surface.h"
#include "schema/schema.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace quoin {
namespace fs = std::filesystem;
namespace {

using Lines = std::vector<std::string>;

constexpr std::size_t kSamples = 50'000; // of each surface
constexpr double kReach = 1.0;           // [m]; surfaces farther apart count as this far

std::string distances_text(const TriangleMesh& from, const TriangleMesh& to)
{
    if (from.face.empty() || to.face.empty()) return "no surface";
    std::vector<Eigen::Vector3d> points;
    for (const auto& sample : sample_surface(from, kSamples))
        points.push_back(sample.position);
    std::vector<double> found = distances(points, NearestItem(to), kReach);
    const double largest = found.empty() ? 0.0 : *std::ranges::max_element(found);
    const DistanceStatistics s = statistics(std::move(found));
    return fmt::format("mean {:.3f}, RMS {:.3f}, 95 % {:.3f}, largest {:.3f} mm", s.mean * kMillimetres,
                       s.rms * kMillimetres, s.p95 * kMillimetres, largest * kMillimetres);
}

void add_distances(Lines& lines, const TriangleMesh& first, const TriangleMesh& second)
{
    lines.push_back(fmt::format("vertices {}, {}; faces {}, {}", first.position.size(), second.position.size(),
                                first.face.size(), second.face.size()));
    lines.push_back("distance, first to second: " + distances_text(first, second));
    lines.push_back("distance, second to first: " + distances_text(second, first));
}

void add_planes(Lines& lines, const PlaneMesh& first, const PlaneMesh& second)
{
    const PlaneMatches matches = match_planes(first, second);
    lines.push_back(
        fmt::format("planes {}, {}: {} matched, {} only in the first ({:.2f} m^2), {} only in the second ({:.2f} m^2)",
                    first.plane.size(), second.plane.size(), matches.pairs.size(), matches.only_first.size(),
                    matches.area_only_first, matches.only_second.size(), matches.area_only_second));
    if (matches.pairs.empty()) return;
    std::vector<double> angles, offsets;
    for (const auto& pair : matches.pairs) {
        angles.push_back(pair.angle * kDegrees);
        offsets.push_back(pair.offset * kMillimetres);
    }
    lines.push_back(fmt::format(
        "matched planes: angle median {:.4f}, largest {:.4f} deg; offset median {:.3f}, largest {:.3f} mm",
        median(angles), *std::ranges::max_element(angles), median(offsets), *std::ranges::max_element(offsets)));
}

void add_pages(Lines& lines, const TexturedMesh& first, const TexturedMesh& second)
{
    if (first.page.size() != second.page.size())
        lines.push_back(fmt::format("texture pages {}, {}", first.page.size(), second.page.size()));
    for (std::size_t i = 0; i < std::min(first.page.size(), second.page.size()); ++i) {
        const std::string name = fmt::format("page {}", i);
        const ColorImage a = decode_color(first.page[i].image, name), b = decode_color(second.page[i].image, name);
        if (a.width != b.width || a.height != b.height)
            lines.push_back(fmt::format("{}: {} x {}, {} x {} px", name, a.width, a.height, b.width, b.height));
        else
            lines.push_back(fmt::format("{}: PSNR {:.2f} dB", name, psnr(a, b, Mask(a.width, a.height, 1))));
    }
}

} // namespace

Lines compare_meshes(const fs::path& first, const fs::path& second)
{
    Lines lines;
    add_distances(lines, read_mesh(first), read_mesh(second));
    return lines;
}

Lines compare_plane_meshes(const fs::path& first, const fs::path& second)
{
    const PlaneMesh a = read_plane_mesh(first), b = read_plane_mesh(second);
    Lines lines;
    add_distances(lines, a.mesh, b.mesh);
    add_planes(lines, a, b);
    return lines;
}

Lines compare_textured_meshes(const fs::path& first, const fs::path& second)
{
    const TexturedMesh a = read_textured_mesh(first), b = read_textured_mesh(second);
    Lines lines;
    add_distances(lines, a.planes.mesh, b.planes.mesh);
    add_planes(lines, a.planes, b.planes);
    add_pages(lines, a, b);
    return lines;
}

} // namespace quoin
