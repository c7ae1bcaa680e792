#include "simplify/outlines.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace quoin {

PlaneFrame::PlaneFrame(const Plane& plane, const Eigen::Vector3d& origin)
    : origin_(origin), u_(plane.normal.unitOrthogonal()), v_(plane.normal.cross(u_))
{
}

Outlines::Outlines(const PlaneMesh& planes, const Curves& curves, const std::vector<std::uint8_t>& skip)
    : planes_(planes), curves_(curves), first_(planes.plane.size() + 1, 0), skip_(skip)
{
    const auto for_planes = [&](const auto& visit) {
        for (CurveId id = 0; id < curves.curve.size(); ++id)
            for (const PlaneId p : curves.curve[id].planes)
                if (p != kNoPlane) visit(p, id);
    };
    for_planes([&](PlaneId p, CurveId) { ++first_[p + 1]; });
    for (std::size_t p = 0; p + 1 < first_.size(); ++p)
        first_[p + 1] += first_[p];
    curve_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for_planes([&](PlaneId p, CurveId id) { curve_[next[p]++] = id; });
}

PlaneOutline Outlines::of(PlaneId p, const std::vector<Eigen::Vector3d>& position) const
{
    PlaneOutline result;
    std::vector<std::array<VertexId, 2>> ends;
    for (const CurveId id : curves_of(p)) {
        if (skip_[id]) continue;
        const Curve& curve = curves_.curve[id];
        const bool along = curve.runs[curve.planes[0] == p ? 0 : 1] > 0;
        for (std::uint32_t s = curve.head; curves_.next[s] != Curves::kNone;) {
            const std::uint32_t t = curves_.next[s];
            const VertexId a = curves_.vertex[s], b = curves_.vertex[t];
            result.source.push_back({id, s, t});
            ends.push_back(along ? std::array{a, b} : std::array{b, a});
            s = t;
            if (s == curve.head) break;
        }
    }
    std::vector<std::uint64_t> uses; // a vertex and which of the ends it is
    uses.reserve(2 * ends.size());
    for (const auto& [a, b] : ends)
        for (const VertexId v : {a, b})
            uses.push_back((std::uint64_t{v} << 32) | uses.size());
    std::sort(uses.begin(), uses.end());
    result.outline.segment.resize(ends.size());
    for (const std::uint64_t use : uses) {
        const auto v = static_cast<VertexId>(use >> 32);
        const auto end = static_cast<std::uint32_t>(use);
        if (result.vertex.empty() || result.vertex.back() != v) result.vertex.push_back(v);
        result.outline.segment[end / 2][end % 2] = static_cast<std::uint32_t>(result.vertex.size() - 1);
    }
    if (result.vertex.empty()) return result;
    const PlaneFrame frame(planes_.plane[p], position[result.vertex.front()]);
    for (const VertexId v : result.vertex)
        result.outline.point.push_back(frame(position[v]));
    return result;
}

} // namespace quoin
