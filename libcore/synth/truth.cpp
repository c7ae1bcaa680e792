#include "synth/truth.h"

#include "base/parallel.h"
#include "base/progress.h"
#include "synth/creases.h"
#include "synth/random.h"
#include "synth/sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSightLift = 1e-3;    // of points off their surface when asking who sees them [m]
constexpr double kCreaseStep = 0.02;   // between points of a crease [m]
constexpr double kBesideCrease = 0.01; // where a side of a crease is looked at [m]
constexpr double kEnoughViews = 1;

Rgb8 rounded_rgb8(const Eigen::Vector3f& color)
{
    const auto byte = [](float v) { return static_cast<std::uint8_t>(std::clamp(v + 0.5f, 0.0f, 255.0f)); };
    return {byte(color.x()), byte(color.y()), byte(color.z())};
}

// Splits a triangle in halves across its longest edge until no edge is longer than `longest`.
void add_split(GroundTruth& truth, const PaintedRoom& room, const Facet& facet, double longest)
{
    std::size_t split = 0;
    double length = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
        if (const double l = (facet.corner[(k + 1) % 3] - facet.corner[k]).norm(); l > length) length = l, split = k;
    if (length > longest) {
        const std::size_t next = (split + 1) % 3;
        const Vector3d middle = 0.5 * (facet.corner[split] + facet.corner[next]);
        const Vector2d middle_uv = 0.5 * (facet.uv[split] + facet.uv[next]);
        Facet half = facet;
        half.corner[next] = middle, half.uv[next] = middle_uv;
        add_split(truth, room, half, longest);
        half = facet;
        half.corner[split] = middle, half.uv[split] = middle_uv;
        add_split(truth, room, half, longest);
        return;
    }
    const auto first = static_cast<VertexId>(truth.mesh.position.size());
    for (std::size_t k = 0; k < 3; ++k) {
        truth.mesh.position.push_back(facet.corner[k].cast<float>());
        truth.mesh.color.push_back(rounded_rgb8(room.color_at(facet.surface, facet.uv[k])));
    }
    truth.mesh.face.push_back({first, first + 1, first + 2});
    truth.face_plane.push_back(facet.surface < room.room.planar.size() ? facet.surface : kNoPlane);
}

// Vertices at one place become one, in the order of their first use; the colour is that of the first.
void weld(TriangleMesh& mesh)
{
    std::vector<VertexId> order(mesh.position.size()), home(mesh.position.size());
    for (VertexId v = 0; v < order.size(); ++v)
        order[v] = v;
    const auto key = [&](VertexId v) {
        return std::array{mesh.position[v].x(), mesh.position[v].y(), mesh.position[v].z()};
    };
    std::sort(order.begin(), order.end(),
              [&](VertexId a, VertexId b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
    for (std::size_t i = 0; i < order.size(); ++i)
        home[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? home[order[i - 1]] : order[i];
    std::vector<VertexId> renamed(order.size());
    TriangleMesh welded;
    for (VertexId v = 0; v < order.size(); ++v) {
        if (home[v] == v) {
            renamed[v] = static_cast<VertexId>(welded.position.size());
            welded.position.push_back(mesh.position[v]);
            welded.color.push_back(mesh.color[v]);
        } else {
            renamed[v] = renamed[home[v]];
        }
    }
    for (Face face : mesh.face) {
        for (VertexId& v : face)
            v = renamed[v];
        welded.face.push_back(face);
    }
    mesh = std::move(welded);
}

class Observers {
public:
    Observers(const PaintedRoom& room, const std::vector<View>& views, const SynthParams& params)
        : room_(room), views_(views), params_(params)
    {
        const double flattest = params.grazing_limit > 0.0 ? params.grazing_limit - kGrazingFade : 90.0;
        least_cosine_ = std::cos(flattest * std::numbers::pi / 180.0);
    }
    std::uint32_t count(const Vector3d& point, const Vector3d& normal) const
    {
        const Vector3d lifted = point + kSightLift * normal;
        return static_cast<std::uint32_t>(
            std::count_if(views_.begin(), views_.end(), [&](const View& view) { return sees(view, lifted, normal); }));
    }

private:
    bool sees(const View& view, const Vector3d& point, const Vector3d& normal) const
    {
        const Vector3d eye = view.world_from_camera.translation(),
                       p_camera = view.world_from_camera.linear().transpose() * (point - eye);
        if (p_camera.z() <= params_.min_depth || (params_.max_depth > 0.0 && p_camera.z() > params_.max_depth))
            return false;
        if (!view.camera.contains(view.camera.project(p_camera))) return false;
        if (normal.dot((eye - point).normalized()) <= least_cosine_) return false;
        return !room_.rays.blocked(point.cast<float>(), eye.cast<float>());
    }

    const PaintedRoom& room_;
    const std::vector<View>& views_;
    const SynthParams& params_;
    double least_cosine_ = 0.0;
};

std::vector<TrueSample> draw_samples(const PaintedRoom& room, const Observers& observers, const SynthParams& params)
{
    std::vector<double> area_up_to{0.0};
    for (const Facet& facet : room.facets)
        area_up_to.push_back(area_up_to.back() + facet.area_vector().norm());
    std::vector<TrueSample> samples(static_cast<std::size_t>(params.truth_samples));
    Progress progress("sampling the truth", samples.size());
    parallel_for(
        samples.size(),
        [&](std::size_t i) {
            CounterRandom random(static_cast<std::uint64_t>(params.seed), RandomPurpose::Truth, i);
            const double at =
                (static_cast<double>(i) + random.uniform()) / static_cast<double>(samples.size()) * area_up_to.back();
            const auto above = std::upper_bound(area_up_to.begin() + 1, area_up_to.end() - 1, at);
            const Facet& facet = room.facets[static_cast<std::size_t>(above - area_up_to.begin()) - 1];
            const double root = std::sqrt(random.uniform()), b = root * (1.0 - random.uniform()), c = root - b;
            const Vector3d point = (1.0 - root) * facet.corner[0] + b * facet.corner[1] + c * facet.corner[2];
            const Vector2d uv = (1.0 - root) * facet.uv[0] + b * facet.uv[1] + c * facet.uv[2];
            const Vector3d normal = facet.area_vector().normalized();
            const PlaneId plane = facet.surface < room.room.planar.size() ? facet.surface : kNoPlane;
            samples[i] = {point.cast<float>(), normal.cast<float>(), rounded_rgb8(room.color_at(facet.surface, uv)),
                          plane, observers.count(point, normal)};
            progress.step();
        },
        256);
    return samples;
}

// Cuts a crease into the stretches that were and were not observed.
std::vector<TrueCrease> observe_crease(const Room& room, const RoomCrease& crease, const Observers& observers)
{
    const Plane &a = room.planar[crease.planes[0]].plane, &b = room.planar[crease.planes[1]].plane;
    const Vector3d way = crease.ends[1] - crease.ends[0];
    const int steps = std::max(1, static_cast<int>(std::round(way.norm() / kCreaseStep)));
    TrueCrease part;
    part.planes = crease.planes;
    part.angle = std::acos(std::clamp(a.normal.dot(b.normal), -1.0, 1.0));
    part.concave = crease.inward[0].dot(b.normal) > 0.0;
    std::vector<TrueCrease> parts;
    for (int i = 0; i < steps; ++i) {
        const Vector3d point = crease.ends[0] + way * ((i + 0.5) / steps);
        const bool observed = observers.count(point + kBesideCrease * crease.inward[0], a.normal) >= kEnoughViews &&
                              observers.count(point + kBesideCrease * crease.inward[1], b.normal) >= kEnoughViews;
        const Vector3d from = crease.ends[0] + way * (static_cast<double>(i) / steps),
                       to = crease.ends[0] + way * ((i + 1.0) / steps);
        if (!parts.empty() && parts.back().observed == observed) {
            parts.back().ends[1] = to;
            continue;
        }
        part.ends = {from, to};
        part.observed = observed;
        parts.push_back(part);
    }
    return parts;
}

} // namespace

GroundTruth survey_room(const PaintedRoom& room, const std::vector<View>& views, const SynthParams& params)
{
    GroundTruth truth;
    const Observers observers(room, views, params);
    for (const Facet& facet : room.facets)
        add_split(truth, room, facet, params.truth_edge);
    weld(truth.mesh);
    for (const PlanarSurface& surface : room.room.planar) {
        double area = 0.0;
        for (const Polygon& piece : surface.pieces)
            area += polygon_area(piece);
        truth.plane.push_back({surface.name, surface.plane, area});
    }
    const std::vector<RoomCrease> creases = find_creases(room.room);
    std::vector<std::vector<TrueCrease>> parts(creases.size());
    parallel_for(creases.size(), [&](std::size_t i) { parts[i] = observe_crease(room.room, creases[i], observers); });
    for (const auto& list : parts)
        truth.crease.insert(truth.crease.end(), list.begin(), list.end());
    truth.sample = draw_samples(room, observers, params);
    return truth;
}

} // namespace quoin
