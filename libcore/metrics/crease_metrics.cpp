#include "base/parallel.h"
#include "mesh/adjacency.h"
#include "metrics/surface.h"
#include "metrics/truth_metrics.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kCreaseGrain = 256;

struct CreaseLine {
    Segment3 ends;
    double angle = 0.0; // between the normals [rad]
    bool asked = true;  // counts in recall
};

double angle_between(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

// Edges between two planes of the model that turn enough.
std::vector<CreaseLine> model_creases(const PlaneMesh& model, double least_angle)
{
    const std::vector<std::uint32_t> opposite = opposite_half_edges(model.mesh);
    std::vector<CreaseLine> creases;
    for (std::uint32_t h = 0; h < opposite.size(); ++h) {
        if (opposite[h] >= kNonManifoldEdge || opposite[h] < h) continue;
        const FaceId f = h / 3, g = opposite[h] / 3;
        if (model.face_plane[f] == model.face_plane[g]) continue;
        const double angle =
            angle_between(model.plane[model.face_plane[f]].normal, model.plane[model.face_plane[g]].normal);
        if (angle < least_angle) continue;
        creases.push_back(
            {{corner(model.mesh, f, static_cast<int>(h % 3)), corner(model.mesh, f, static_cast<int>((h + 1) % 3))},
             angle});
    }
    return creases;
}

std::vector<CreaseLine> true_creases(const GroundTruth& truth, const EvaluateParams& params)
{
    std::vector<CreaseLine> creases;
    for (const TrueCrease& c : truth.crease) {
        if (c.angle < params.crease_angle / kDegrees) continue;
        creases.push_back({c.ends, c.angle, c.observed && (c.ends[1] - c.ends[0]).norm() >= params.crease_length});
    }
    return creases;
}

NearestItem tree_of(const std::vector<CreaseLine>& creases)
{
    std::vector<Segment3> segments;
    for (const CreaseLine& c : creases)
        segments.push_back(c.ends);
    return NearestItem(segments);
}

// A point of a crease every `step`, each standing for the same length of its own crease.
struct CreasePoint {
    Vector3d position;
    std::uint32_t crease;
    double length; // [m]
};
std::vector<CreasePoint> points_along(const std::vector<CreaseLine>& creases, double step)
{
    std::vector<CreasePoint> points;
    for (std::uint32_t i = 0; i < creases.size(); ++i) {
        const Segment3& s = creases[i].ends;
        const double length = (s[1] - s[0]).norm();
        const int count = std::max(1, static_cast<int>(std::ceil(length / step)));
        for (int k = 0; k < count; ++k)
            points.push_back({s[0] + (k + 0.5) / count * (s[1] - s[0]), i, length / count});
    }
    return points;
}

// Length-weighted share of points with something of `tree` within the tolerance; `visit` sees the pairs in order.
template <class Visit>
double share_near(const std::vector<CreasePoint>& points, const NearestItem& tree, double tolerance, const Visit& visit)
{
    std::vector<std::optional<NearestPoint>> near(points.size());
    parallel_for(
        points.size(), [&](std::size_t i) { near[i] = tree.find(points[i].position, tolerance); }, kCreaseGrain);
    double all = 0.0, matched = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        all += points[i].length;
        if (!near[i]) continue;
        matched += points[i].length;
        visit(points[i], *near[i]);
    }
    return matched / all;
}

// Crease points of the model whose nearest true crease is this one.
struct Followers {
    std::vector<Vector3d> position; // [m]
    std::vector<double> length;     // [m]
};

// Sum over the points of length times squared distance to the straight line that fits them best [m^3].
double squared_bend(const Followers& points)
{
    double length = 0.0;
    Vector3d mean = Vector3d::Zero();
    for (std::size_t i = 0; i < points.length.size(); ++i) {
        length += points.length[i];
        mean += points.length[i] * points.position[i];
    }
    if (!(length > 0.0)) return 0.0;
    mean /= length;
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < points.length.size(); ++i) {
        const Vector3d d = points.position[i] - mean;
        scatter += points.length[i] * d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter, Eigen::EigenvaluesOnly);
    return std::max(0.0, axes.eigenvalues()[0]) + std::max(0.0, axes.eigenvalues()[1]);
}

// Half of the length is nearer than this.
double median_by_length(std::vector<std::pair<double, double>> distance_and_length, double length)
{
    std::sort(distance_and_length.begin(), distance_and_length.end());
    double below = 0.0;
    for (const auto& [distance, part] : distance_and_length) {
        below += part;
        if (below >= 0.5 * length) return distance;
    }
    return 0.0;
}

// How far the model's creases run from the asked true crease that is nearest, and how far from straight along it.
void add_course_metrics(MetricList& list, const std::vector<CreasePoint>& model, const std::vector<CreaseLine>& real,
                        const NearestItem& real_tree, double reach)
{
    std::vector<Followers> followers(real.size());
    std::vector<std::pair<double, double>> distance_and_length;
    double length = 0.0, squares = 0.0, bend = 0.0;
    share_near(model, real_tree, reach, [&](const CreasePoint& p, const NearestPoint& near) {
        if (!real[near.item].asked) return;
        followers[near.item].position.push_back(p.position);
        followers[near.item].length.push_back(p.length);
        distance_and_length.emplace_back(near.distance, p.length);
        length += p.length;
        squares += p.length * near.distance * near.distance;
    });
    for (const Followers& points : followers)
        bend += squared_bend(points);
    list.lower("creases.model_distance.median", "mm", median_by_length(distance_and_length, length) * kMillimetres);
    list.lower("creases.model_distance.rms", "mm", std::sqrt(squares / length) * kMillimetres);
    list.lower("creases.straightness.rms", "mm", std::sqrt(bend / length) * kMillimetres);
}

} // namespace

void add_crease_metrics(MetricList& list, const PlaneMesh& model, const GroundTruth& truth,
                        const EvaluateParams& params)
{
    const std::vector<CreaseLine> found = model_creases(model, params.crease_angle / kDegrees),
                                  real = true_creases(truth, params);
    std::vector<CreaseLine> asked;
    std::copy_if(real.begin(), real.end(), std::back_inserter(asked), [](const CreaseLine& c) { return c.asked; });
    const NearestItem found_tree = tree_of(found), real_tree = tree_of(real);
    std::vector<double> turn, distance;
    const double recall = share_near(points_along(asked, params.crease_step), found_tree, params.crease_tolerance,
                                     [&](const CreasePoint& p, const NearestPoint& near) {
                                         turn.push_back(std::abs(found[near.item].angle - asked[p.crease].angle));
                                         distance.push_back(near.distance);
                                     });
    std::vector<double> ends;
    const std::vector<CreasePoint> model_points = points_along(found, params.crease_step);
    const double precision =
        share_near(model_points, real_tree, params.crease_tolerance, [](const CreasePoint&, const NearestPoint&) {});
    for (const CreaseLine& c : found)
        for (const Vector3d& end : c.ends)
            if (const auto near = real_tree.find(end, params.match_distance)) ends.push_back(near->distance);
    list.plain("creases.asked", "", static_cast<double>(asked.size()));
    list.higher("creases.recall", "", recall);
    list.higher("creases.precision", "", precision);
    list.higher("creases.f_score", "", 2.0 * recall * precision / (recall + precision));
    list.lower("creases.distance.median", "mm", median(distance) * kMillimetres);
    list.lower("creases.dihedral.median", "deg", median(turn) * kDegrees);
    list.lower("creases.vertex_distance.median", "mm", median(ends) * kMillimetres);
    add_course_metrics(list, model_points, real, real_tree, params.match_distance);
}

} // namespace quoin
