#include "fill/patch.h"

#include "mesh/hygiene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

namespace quoin {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kMostPlanes = 8; // planes of a loop that are tried, those with most border first
constexpr double kOnBoth = 0.1;        // part of plane_distance within which a vertex counts to both of two planes

Vector3d position_of(const PlaneMesh& mesh, VertexId v) { return mesh.mesh.position[v].cast<double>(); }

// Where a loop passes from one plane to the next.
struct Passage {
    VertexId vertex = 0; // on both
    Vector3d position = Vector3d::Zero();
    std::size_t index = 0; // of the vertex in the loop; of the last one before when the vertex is new
    bool is_new = false;
};

// Each vertex of a loop with the one of several planes that it belongs to, or with none when it belongs to more.
struct Labels {
    std::vector<int> of_vertex; // into the planes; kShared
    static constexpr int kShared = -1;
};

// Indices of the loop after which the label changes, in order, with the labels before and after.
struct Change {
    std::size_t last = 0, next = 0; // vertices with a label of their own on both sides; those between are shared
    int from = 0, to = 0;
};

std::vector<Change> changes_of(const Labels& labels)
{
    std::vector<std::size_t> own;
    for (std::size_t i = 0; i < labels.of_vertex.size(); ++i)
        if (labels.of_vertex[i] != Labels::kShared) own.push_back(i);
    std::vector<Change> changes;
    for (std::size_t i = 0; i < own.size(); ++i) {
        const std::size_t a = own[i], b = own[(i + 1) % own.size()];
        if (labels.of_vertex[a] != labels.of_vertex[b])
            changes.push_back({a, b, labels.of_vertex[a], labels.of_vertex[b]});
    }
    return changes;
}

bool are_distinct(const std::vector<Change>& changes)
{
    for (std::size_t i = 0; i < changes.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (changes[i].from == changes[j].from) return false;
    return true;
}

} // namespace

Vector3d position_of(const PlaneMesh& mesh, const Patch& patch, VertexId v)
{
    const std::size_t known = mesh.mesh.position.size();
    return v < known ? position_of(mesh, v) : patch.vertex[v - known];
}

std::array<Vector3d, 3> corners_of(const PlaneMesh& mesh, const Patch& patch, const Face& face)
{
    return {position_of(mesh, patch, face[0]), position_of(mesh, patch, face[1]), position_of(mesh, patch, face[2])};
}

Outline outline_of(const PlaneMesh& mesh, const BorderLoop& loop)
{
    Outline outline{loop.vertex, {}};
    for (const VertexId v : loop.vertex)
        outline.position.push_back(position_of(mesh, v));
    return outline;
}

double signed_area(const Outline& outline, const Vector3d& normal)
{
    Vector3d twice = Vector3d::Zero();
    const Vector3d& origin = outline.position[0];
    for (std::size_t i = 1; i + 1 < outline.position.size(); ++i)
        twice += (outline.position[i] - origin).cross(outline.position[i + 1] - origin);
    return twice.dot(normal) / 2.0;
}

bool encloses(const Outline& outline, const Plane& plane, const Vector3d& point)
{
    const Vector3d u = plane.normal.unitOrthogonal(), v = plane.normal.cross(u);
    bool inside = false;
    for (std::size_t i = 0, j = outline.position.size() - 1; i < outline.position.size(); j = i++) {
        const Vector3d a = outline.position[i] - point, b = outline.position[j] - point;
        if ((v.dot(a) > 0.0) == (v.dot(b) > 0.0)) continue;
        if (u.dot(a) - v.dot(a) * (u.dot(b) - u.dot(a)) / (v.dot(b) - v.dot(a)) > 0.0) inside = !inside;
    }
    return inside;
}

Proposer::Proposer(const PlaneMesh& mesh, const std::vector<BorderLoop>& loops, const FillHolesParams& params)
    : mesh_(mesh), params_(params), vertex_planes_(vertex_planes(mesh.mesh, mesh.face_plane)),
      islands_(mesh.plane.size())
{
    for (const BorderLoop& loop : loops) {
        const PlaneId plane = loop.plane[0];
        const bool is_one = std::ranges::all_of(loop.plane, [&](PlaneId p) { return p == plane; });
        if (!is_one || !lies_on(loop, plane)) continue;
        Outline outline = outline_of(mesh, loop);
        if (signed_area(outline, mesh.plane[plane].normal) < 0.0) islands_[plane].push_back(std::move(outline));
    }
}

bool Proposer::lies_on(const BorderLoop& loop, PlaneId plane) const
{
    return std::ranges::all_of(loop.vertex, [&](VertexId v) {
        return std::abs(mesh_.plane[plane].signed_distance(position_of(mesh_, v))) <= params_.plane_distance;
    });
}

// Planes along the loop by falling length of border.
std::vector<PlaneId> Proposer::candidates_of(const BorderLoop& loop) const
{
    std::map<PlaneId, double> length;
    for (std::size_t i = 0; i < loop.vertex.size(); ++i) {
        const VertexId a = loop.vertex[i], b = loop.vertex[(i + 1) % loop.vertex.size()];
        if (loop.plane[i] != kNoPlane) length[loop.plane[i]] += (position_of(mesh_, b) - position_of(mesh_, a)).norm();
    }
    std::vector<PlaneId> planes;
    for (const auto& [plane, _] : length)
        planes.push_back(plane);
    std::ranges::stable_sort(planes, [&](PlaneId a, PlaneId b) { return length[a] > length[b]; });
    planes.resize(std::min(planes.size(), kMostPlanes));
    return planes;
}

std::optional<Patch> Proposer::on_one_plane(const BorderLoop& loop, PlaneId plane) const
{
    if (!lies_on(loop, plane)) return std::nullopt;
    const Outline outline = outline_of(mesh_, loop);
    std::vector<Outline> within;
    for (const Outline& island : islands_[plane])
        if (island.vertex != outline.vertex && encloses(outline, mesh_.plane[plane], island.position[0]))
            within.push_back(island);
    auto faces = triangulate_on_plane(outline, within, mesh_.plane[plane]);
    if (!faces) return std::nullopt;
    const std::size_t count = faces->size();
    return Patch{{}, std::move(*faces), std::vector<PlaneId>(count, plane)};
}

namespace {

// Closes a loop on two or three planes up to where they meet.
class Corner {
public:
    Corner(const PlaneMesh& mesh, const BorderLoop& loop, const VertexPlanes& vertex_planes,
           const FillHolesParams& params, const std::vector<PlaneId>& planes)
        : mesh_(mesh), loop_(loop), vertex_planes_(vertex_planes), params_(params), planes_(planes)
    {
    }

    std::optional<Patch> close()
    {
        if (!label()) return std::nullopt;
        const auto changes = changes_of(labels_);
        if (changes.size() != planes_.size() || !are_distinct(changes) || !find_meeting()) return std::nullopt;
        for (const Change& change : changes)
            passages_.push_back(pass(change));
        for (std::size_t i = 0; i < changes.size(); ++i)
            if (!close_side(passages_[(i + changes.size() - 1) % changes.size()], passages_[i], changes[i].from))
                return std::nullopt;
        return std::move(patch_);
    }

private:
    Vector3d at(std::size_t i) const { return position_of(mesh_, loop_.vertex[i]); }

    double distance(const Vector3d& p, std::size_t plane) const
    {
        return std::abs(mesh_.plane[planes_[plane]].signed_distance(p));
    }

    bool touches(VertexId v, std::size_t plane) const
    {
        return std::ranges::count(vertex_planes_.of(v), planes_[plane]) > 0;
    }

    bool is_on(std::size_t i, std::size_t plane) const
    {
        return touches(loop_.vertex[i], plane) || distance(at(i), plane) <= kOnBoth * params_.plane_distance;
    }

    // False when a vertex is on none of the planes.
    bool label()
    {
        for (std::size_t i = 0; i < loop_.vertex.size(); ++i) {
            std::size_t nearest = 0, shared = 0;
            for (std::size_t p = 0; p < planes_.size(); ++p) {
                if (distance(at(i), p) < distance(at(i), nearest)) nearest = p;
                shared += is_on(i, p) ? 1 : 0;
            }
            if (distance(at(i), nearest) > params_.plane_distance) return false;
            labels_.of_vertex.push_back(shared > 1 ? Labels::kShared : static_cast<int>(nearest));
        }
        return true;
    }

    // The middle of the loop, moved to where the planes meet; false when they do not or the loop reaches too far.
    bool find_meeting()
    {
        Vector3d middle = Vector3d::Zero();
        for (std::size_t i = 0; i < loop_.vertex.size(); ++i)
            middle += at(i) / static_cast<double>(loop_.vertex.size());
        std::vector<Plane> planes;
        for (const PlaneId p : planes_)
            planes.push_back(mesh_.plane[p]);
        const double min_angle = params_.min_angle * std::numbers::pi / 180.0;
        const PlaneMeeting meeting = meet_planes(middle, planes, min_angle);
        if (meeting.rank != static_cast<int>(planes.size())) return false;
        meeting_ = meeting.point;
        for (std::size_t i = 0; i < loop_.vertex.size(); ++i)
            for (std::size_t p = 0; p < planes_.size(); ++p)
                if (distance(at(i), p) > params_.max_gap) return false;
        return true;
    }

    VertexId add_vertex(const Vector3d& position)
    {
        patch_.vertex.push_back(position);
        return static_cast<VertexId>(mesh_.mesh.position.size() + patch_.vertex.size() - 1);
    }

    // A vertex of the loop on both planes, the one nearest to the meeting, or else a new one, which takes a face of its
    // own to the border.
    Passage pass(const Change& change)
    {
        const std::size_t n = loop_.vertex.size();
        std::optional<std::size_t> best;
        for (std::size_t i = (change.last + 1) % n; i != change.next; i = (i + 1) % n)
            if (is_on(i, static_cast<std::size_t>(change.from)) && is_on(i, static_cast<std::size_t>(change.to)) &&
                (!best || (at(i) - meeting_).norm() < (at(*best) - meeting_).norm()))
                best = i;
        if (best) return {loop_.vertex[*best], at(*best), *best, false};
        const std::size_t after = (change.last + 1) % n;
        std::vector<Plane> planes{mesh_.plane[planes_[static_cast<std::size_t>(change.from)]],
                                  mesh_.plane[planes_[static_cast<std::size_t>(change.to)]]};
        const PlaneId beside = loop_.plane[change.last];
        if (beside != kNoPlane && std::ranges::count(planes_, beside) == 0) planes.push_back(mesh_.plane[beside]);
        const double min_angle = params_.min_angle * std::numbers::pi / 180.0;
        const Vector3d position = meet_planes((at(change.last) + at(after)) / 2.0, planes, min_angle).point;
        const VertexId vertex = add_vertex(position);
        if (beside != kNoPlane) {
            patch_.face.push_back({loop_.vertex[change.last], loop_.vertex[after], vertex});
            patch_.plane.push_back(beside);
        }
        return {vertex, position, change.last, true};
    }

    // The part of the loop from one passage to the next, closed along the meeting of the planes.
    bool close_side(const Passage& begin, const Passage& end, int side)
    {
        const std::size_t n = loop_.vertex.size();
        Outline outline;
        const auto add = [&](VertexId v, const Vector3d& p) {
            outline.vertex.push_back(v);
            outline.position.push_back(p);
        };
        add(begin.vertex, begin.position);
        for (std::size_t i = (begin.index + 1) % n; i != end.index; i = (i + 1) % n)
            add(loop_.vertex[i], at(i));
        if (end.is_new) add(loop_.vertex[end.index], at(end.index));
        add(end.vertex, end.position);
        if (planes_.size() > 2) add(center(), meeting_);
        const PlaneId plane = planes_[static_cast<std::size_t>(side)];
        const auto faces = triangulate_on_plane(outline, {}, mesh_.plane[plane]);
        if (!faces) return false;
        patch_.face.insert(patch_.face.end(), faces->begin(), faces->end());
        patch_.plane.insert(patch_.plane.end(), faces->size(), plane);
        return true;
    }

    VertexId center()
    {
        if (!center_) center_ = add_vertex(meeting_);
        return *center_;
    }

    const PlaneMesh& mesh_;
    const BorderLoop& loop_;
    const VertexPlanes& vertex_planes_;
    const FillHolesParams& params_;
    const std::vector<PlaneId>& planes_;
    Labels labels_;
    Vector3d meeting_ = Vector3d::Zero();
    std::optional<VertexId> center_;
    std::vector<Passage> passages_;
    Patch patch_;
};

} // namespace

std::optional<Patch> Proposer::between_planes(const BorderLoop& loop, const std::vector<PlaneId>& planes) const
{
    return Corner(mesh_, loop, vertex_planes_, params_, planes).close();
}

namespace {

// Of the face on an edge of the loop.
VertexId third_vertex(const PlaneMesh& mesh, const BorderLoop& loop, std::size_t edge)
{
    const Face& face = mesh.mesh.face[loop.face[edge]];
    const VertexId a = loop.vertex[edge], b = loop.vertex[(edge + 1) % loop.vertex.size()];
    return *std::ranges::find_if(face, [&](VertexId v) { return v != a && v != b; });
}

} // namespace

// All faces get the plane along the border that the whole loop lies nearest to, so that no plane falls apart. A loop
// around a loose piece would be closed by its back.
std::optional<Patch> Proposer::anyhow(const BorderLoop& loop) const
{
    const Outline outline = outline_of(mesh_, loop);
    double length = 0.0, facing = 0.0;
    for (std::size_t i = 0; i < loop.vertex.size(); ++i) {
        length += (outline.position[(i + 1) % loop.vertex.size()] - outline.position[i]).norm();
        facing += signed_area(outline, mesh_.plane[loop.plane[i]].normal);
    }
    if (length > params_.max_rest_border || facing <= 0.0) return std::nullopt;
    std::vector<Vector3d> beside;
    for (std::size_t i = 0; i < loop.vertex.size(); ++i)
        beside.push_back(position_of(mesh_, third_vertex(mesh_, loop, i)));
    auto faces = triangulate_in_space(outline, beside);
    if (!faces) return std::nullopt;
    const auto worst = [&](PlaneId p) {
        double distance = 0.0;
        for (const auto& position : outline.position)
            distance = std::max(distance, std::abs(mesh_.plane[p].signed_distance(position)));
        return distance;
    };
    const PlaneId plane =
        *std::ranges::min_element(loop.plane, [&](PlaneId a, PlaneId b) { return worst(a) < worst(b); });
    const std::size_t count = faces->size();
    return Patch{{}, std::move(*faces), std::vector<PlaneId>(count, plane)};
}

// Does no face of the patch look away from its plane, nor lie folded on another one or on the loop's?
bool Proposer::is_clean(const BorderLoop& loop, const Patch& patch) const
{
    std::map<std::pair<VertexId, VertexId>, Vector3d> normal; // of the face on the right of an edge, by its ends
    for (std::size_t i = 0; i < loop.face.size(); ++i)
        normal[{loop.vertex[(i + 1) % loop.vertex.size()], loop.vertex[i]}] = face_normal(mesh_.mesh, loop.face[i]);
    for (std::size_t f = 0; f < patch.face.size(); ++f) {
        const auto c = corners_of(mesh_, patch, patch.face[f]);
        const Vector3d n = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
        if (n.dot(mesh_.plane[patch.plane[f]].normal) < 0.0) return false;
        for (std::size_t k = 0; k < 3; ++k)
            normal[{patch.face[f][k], patch.face[f][(k + 1) % 3]}] = n;
    }
    return std::ranges::none_of(normal, [&](const auto& edge) {
        const auto across = normal.find({edge.first.second, edge.first.first});
        return across != normal.end() && edge.second.dot(across->second) < HygieneLimits{}.folded_cosine;
    });
}

std::optional<Patch> Proposer::propose(const BorderLoop& loop) const
{
    auto patch = propose_bay(loop);
    if (patch && is_clean(loop, *patch)) return patch;
    auto any = anyhow(loop);
    return any && (!patch || is_clean(loop, *any)) ? any : patch;
}

std::optional<Patch> Proposer::propose_bay(const BorderLoop& loop) const
{
    const auto planes = candidates_of(loop);
    std::optional<Patch> first;
    const auto is_found = [&](std::optional<Patch> patch) {
        if (!patch) return false;
        const bool clean = is_clean(loop, *patch);
        if (clean || !first) first = std::move(patch);
        return clean;
    };
    for (std::size_t i = 0; i < planes.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (is_found(between_planes(loop, {planes[j], planes[i]}))) return first;
    for (std::size_t i = 0; i < planes.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            for (std::size_t k = 0; k < j; ++k)
                if (is_found(between_planes(loop, {planes[k], planes[j], planes[i]}))) return first;
    for (const PlaneId plane : planes)
        if (is_found(on_one_plane(loop, plane))) return first;
    return first;
}

} // namespace quoin
