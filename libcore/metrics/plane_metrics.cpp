#include "base/parallel.h"
#include "metrics/surface.h"
#include "metrics/truth_metrics.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace quoin {
namespace {

using Eigen::Vector3d;

constexpr double kLeastMatch = 0.5; // share of a true plane's points that its match must hold
constexpr double kFragment = 0.05;  // model planes with a smaller share are not counted as its pieces
constexpr std::size_t kVoteGrain = 1024;

// The model's plane at every true sample that the scan saw; kNoPlane where the model has none.
std::vector<PlaneId> plane_votes(const PlaneMesh& model, const GroundTruth& truth, const EvaluateParams& params)
{
    const NearestItem surface(model.mesh);
    const double least_cosine = std::cos(params.match_angle / kDegrees);
    std::vector<PlaneId> votes(truth.sample.size(), kNoPlane);
    parallel_for(
        votes.size(),
        [&](std::size_t i) {
            const TrueSample& s = truth.sample[i];
            if (!params.observed(s) || s.plane == kNoPlane) return;
            const auto near = surface.find(s.position.cast<double>(), params.match_distance);
            if (near && face_normal(model.mesh, near->item).dot(s.normal.cast<double>()) >= least_cosine)
                votes[i] = model.face_plane[near->item];
        },
        kVoteGrain);
    return votes;
}

struct TruePlanePoints {
    std::map<PlaneId, std::size_t> votes; // of the model's planes, kNoPlane included
    std::size_t seen = 0, all = 0;
    Vector3d sum = Vector3d::Zero();
};

struct PlaneError {
    double normal = 0.0; // [rad]
    double offset = 0.0; // [m]
};

PlaneError compare(const Plane& found, const TruePlane& truth, const Vector3d& center)
{
    const double sine = found.normal.cross(truth.plane.normal).norm();
    return {std::atan2(sine, std::abs(found.normal.dot(truth.plane.normal))), std::abs(found.signed_distance(center))};
}

} // namespace

void add_plane_metrics(MetricList& list, const PlaneMesh& model, const GroundTruth& truth, const EvaluateParams& params)
{
    const std::vector<PlaneId> votes = plane_votes(model, truth, params);
    std::vector<TruePlanePoints> points(truth.plane.size());
    for (std::size_t i = 0; i < votes.size(); ++i) {
        const TrueSample& s = truth.sample[i];
        if (s.plane >= points.size()) continue;
        ++points[s.plane].all;
        if (!params.observed(s)) continue;
        ++points[s.plane].seen;
        ++points[s.plane].votes[votes[i]];
        points[s.plane].sum += s.position.cast<double>();
    }
    std::vector<double> normal, offset;
    double asked = 0.0, pieces = 0.0;
    for (std::size_t p = 0; p < points.size(); ++p) {
        const TruePlanePoints& q = points[p];
        if (q.seen == 0 ||
            truth.plane[p].area * static_cast<double>(q.seen) / static_cast<double>(q.all) < params.plane_area)
            continue;
        asked += 1.0;
        const auto fewer = [](const auto& a, const auto& b) { return a.second < b.second; };
        auto found = q.votes;
        found.erase(kNoPlane);
        if (found.empty()) continue;
        const auto best = *std::max_element(found.begin(), found.end(), fewer);
        pieces += static_cast<double>(std::count_if(found.begin(), found.end(), [&](const auto& v) {
            return static_cast<double>(v.second) >= kFragment * static_cast<double>(q.seen);
        }));
        if (static_cast<double>(best.second) < kLeastMatch * static_cast<double>(q.seen)) continue;
        const PlaneError error = compare(model.plane[best.first], truth.plane[p], q.sum / static_cast<double>(q.seen));
        normal.push_back(error.normal);
        offset.push_back(error.offset);
    }
    list.plain("planes.asked", "", asked);
    list.higher("planes.matched", "", static_cast<double>(normal.size()) / asked);
    list.lower("planes.pieces", "", pieces / asked);
    list.lower("planes.normal.median", "deg", median(normal) * kDegrees);
    list.lower("planes.normal.p95", "deg", statistics(normal).p95 * kDegrees);
    list.lower("planes.offset.median", "mm", median(offset) * kMillimetres);
    list.lower("planes.offset.p95", "mm", statistics(offset).p95 * kMillimetres);
}

} // namespace quoin
