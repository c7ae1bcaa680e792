#include "refine/refine.h"

#include "base/error.h"
#include "base/log.h"
#include "geometry/units.h"
#include "mesh/adjacency.h"
#include "mesh/creases.h"
#include "mesh/flip_guard.h"
#include "mesh/plane_parts.h"
#include "refine/linear_system.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

// Unknowns are the vertices X (V x 3). With the mass M_f of face f (face_mass), the pull p_f of its plane, the targets
// T of vertices on creases and corners, their data weights m with mean m', and rows L of the regulariser, each solve
// minimises
//     sum_f p_f |X_f - Q_f|_M^2 + (1 - p_f) |X_f - X'_f|_M^2  +  lambda_l sum_v m_v |x_v - T_v|^2  +  lambda_r |L X -
//     g|^2
// where X' are the vertices of the last solve, Q their projections onto the plane of f and T their nearest points on
// the line or the point where their planes meet; g = L X0 for displacements, 0 for positions. The matrix is the same in
// every solve.

namespace quoin {
namespace {

void check_planes(const PlaneMesh& mesh, const std::vector<Plane>& planes)
{
    if (planes.size() != mesh.plane.size())
        throw InputError(fmt::format("the alignment has {} planes and the plane mesh {}; both must come from one mesh",
                                     planes.size(), mesh.plane.size()));
    for (std::size_t p = 0; p < planes.size(); ++p) {
        const bool sound = planes[p].normal.allFinite() && std::isfinite(planes[p].offset) &&
                           std::abs(planes[p].normal.norm() - 1.0) < 1e-3;
        if (!sound) throw InputError(fmt::format("plane {} of the alignment has no finite unit normal and offset", p));
    }
}

// The given planes, facing the side that those of the mesh faced.
std::vector<Plane> oriented_like(const std::vector<Plane>& reference, std::vector<Plane> planes)
{
    for (std::size_t p = 0; p < planes.size(); ++p) {
        const double length = planes[p].normal.norm();
        planes[p] = {planes[p].normal / length, planes[p].offset / length};
        if (planes[p].normal.dot(reference[p].normal) < 0.0) planes[p] = planes[p].flipped();
    }
    return planes;
}

// One row of L: x_v less the mean of its neighbours. Neighbours of v are other[first[v]] .. other[first[v+1]-1].
struct Neighbours {
    std::vector<std::uint32_t> first;
    std::vector<VertexId> other;
};

struct Edge {
    VertexId from = 0, to = 0;
    bool on_border = false;
};

// Every edge from both ends, sorted and unique; on_border where planes or the mesh end.
std::vector<Edge> directed_edges(const PlaneMesh& mesh)
{
    const auto opposite = opposite_half_edges(mesh.mesh);
    std::vector<Edge> edges;
    edges.reserve(2 * opposite.size());
    for (std::uint32_t h = 0; h < opposite.size(); ++h) {
        const VertexId a = mesh.mesh.face[h / 3][h % 3], b = mesh.mesh.face[h / 3][(h % 3 + 1) % 3];
        const bool regular = is_half_edge(opposite[h]);
        const bool inside = regular && mesh.face_plane[opposite[h] / 3] == mesh.face_plane[h / 3];
        edges.push_back({a, b, !inside});
        edges.push_back({b, a, !inside});
    }
    const auto ends = [](const Edge& e) { return std::pair(e.from, e.to); };
    std::sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return ends(a) < ends(b); });
    const auto same = [&](const Edge& a, const Edge& b) { return ends(a) == ends(b); };
    edges.erase(std::unique(edges.begin(), edges.end(), same), edges.end());
    return edges;
}

Neighbours smoothed_neighbours(const PlaneMesh& mesh, Regularizer regularizer)
{
    Neighbours neighbours;
    neighbours.first.assign(mesh.mesh.position.size() + 1, 0);
    for (const Edge& edge : directed_edges(mesh)) {
        const VertexClass here = mesh.vertex_class[edge.from];
        const bool along = here == VertexClass::Inner || (here == VertexClass::Border && edge.on_border);
        if (regularizer == Regularizer::Displacement && !along) continue;
        neighbours.other.push_back(edge.to);
        ++neighbours.first[edge.from + 1];
    }
    for (std::size_t v = 0; v < mesh.mesh.position.size(); ++v)
        neighbours.first[v + 1] += neighbours.first[v];
    return neighbours;
}

class GeometryOptimizer {
public:
    GeometryOptimizer(const PlaneMesh& mesh, const OptimizeGeometryParams& params)
        : mesh_(mesh), params_(params), planes_at_(vertex_planes(mesh.mesh, mesh.face_plane)),
          neighbours_(smoothed_neighbours(mesh, params.regularizer)), start_(points(mesh.mesh))
    {
        weigh_faces();
        weigh_vertices();
    }

    Points run() const
    {
        const LinearSystem system(mesh_.mesh.position.size(), matrix(), params_);
        Points x = start_;
        for (int i = 0; i < params_.iterations; ++i)
            x = limited(system.solve(right_hand_side(x), x));
        return x;
    }

private:
    static Points points(const TriangleMesh& mesh)
    {
        Points x(static_cast<Eigen::Index>(mesh.position.size()), 3);
        for (std::size_t v = 0; v < mesh.position.size(); ++v)
            x.row(static_cast<Eigen::Index>(v)) = mesh.position[v].cast<double>();
        return x;
    }

    void weigh_faces();
    void weigh_vertices();
    std::vector<MatrixEntry> matrix() const;
    void add_regularizer(std::vector<MatrixEntry>& entries) const;
    Points right_hand_side(const Points& x) const;
    Points regularizer_target() const;
    PlaneMeeting crease_target(VertexId v, const Eigen::Vector3d& at) const;
    Points limited(Points x) const;

    const PlaneMesh& mesh_;
    const OptimizeGeometryParams& params_;
    VertexPlanes planes_at_;
    Neighbours neighbours_;
    Points start_;
    std::vector<Eigen::Matrix3d> mass_; // one per face, texels
    std::vector<double> plane_pull_;    // 0..1
    std::vector<double> face_pull_;     // 0..1; 0 where the plane does not explain the face
    std::vector<double> crease_weight_; // one per vertex, texels; 0 away from creases
    double smoothness_ = 0.0;           // texels; weight of a row of L
    double anchor_ = 0.0;               // texels; holds vertices that no face holds
};

void GeometryOptimizer::weigh_faces()
{
    mass_.reserve(mesh_.mesh.face.size());
    for (FaceId f = 0; f < mesh_.mesh.face.size(); ++f)
        mass_.push_back(face_mass(params_.texel_density * std::max(face_area(mesh_.mesh, f), params_.min_face_area)));
    for (std::size_t p = 0; p < mesh_.plane.size(); ++p) {
        const double ratio = params_.max_plane_rms / std::max(rms_to_fit(mesh_.moments[p]), params_.max_plane_rms);
        plane_pull_.push_back(ratio * ratio);
    }
    const double min_cosine = std::cos(radians(params_.max_deviation));
    for (FaceId f = 0; f < mesh_.mesh.face.size(); ++f) {
        const PlaneId p = mesh_.face_plane[f];
        const bool explained = face_normal(mesh_.mesh, f).dot(mesh_.plane[p].normal) >= min_cosine;
        face_pull_.push_back(explained ? plane_pull_[p] : 0.0);
    }
}

void GeometryOptimizer::weigh_vertices()
{
    std::vector<double> data(mesh_.mesh.position.size(), 0.0);
    for (FaceId f = 0; f < mesh_.mesh.face.size(); ++f)
        for (const VertexId v : mesh_.mesh.face[f])
            data[v] += mass_[f](0, 0);
    smoothness_ = params_.lambda_r * std::accumulate(data.begin(), data.end(), 0.0) / static_cast<double>(data.size());
    constexpr double kAnchor = 1e-6;
    anchor_ = kAnchor * params_.texel_density * params_.min_face_area;
    crease_weight_.assign(data.size(), 0.0);
    std::vector<std::uint8_t> explained(data.size(), 1);
    for (FaceId f = 0; f < mesh_.mesh.face.size(); ++f)
        for (const VertexId v : mesh_.mesh.face[f])
            if (face_pull_[f] <= 0.0) explained[v] = 0;
    for (VertexId v = 0; v < data.size(); ++v) {
        const PlaneMeeting meeting = crease_target(v, start_.row(v));
        const bool near_start = (meeting.point - Eigen::Vector3d(start_.row(v))).norm() <= params_.max_move;
        if (!near_start || explained[v] == 0) continue;
        if (planes_at_.of(v).size() > 1 && meeting.rank > 1) crease_weight_[v] = params_.lambda_l * data[v];
    }
}

// Where those planes of a vertex meet that explain their clusters.
PlaneMeeting GeometryOptimizer::crease_target(VertexId v, const Eigen::Vector3d& at) const
{
    std::vector<Plane> planes;
    for (const PlaneId p : planes_at_.of(v))
        if (plane_pull_[p] >= 1.0) planes.push_back(mesh_.plane[p]);
    return meet_planes(at, planes, radians(params_.crease_angle));
}

std::vector<MatrixEntry> GeometryOptimizer::matrix() const
{
    std::vector<MatrixEntry> entries;
    entries.reserve(9 * mesh_.mesh.face.size());
    for (FaceId f = 0; f < mesh_.mesh.face.size(); ++f)
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k)
                entries.push_back({mesh_.mesh.face[f][static_cast<std::size_t>(j)],
                                   mesh_.mesh.face[f][static_cast<std::size_t>(k)], mass_[f](j, k)});
    for (VertexId v = 0; v < crease_weight_.size(); ++v)
        entries.push_back({v, v, crease_weight_[v] + anchor_});
    add_regularizer(entries);
    return entries;
}

// lambda_r m' L^T L, row by row.
void GeometryOptimizer::add_regularizer(std::vector<MatrixEntry>& entries) const
{
    std::vector<std::pair<VertexId, double>> row;
    for (VertexId v = 0; v < crease_weight_.size(); ++v) {
        const std::uint32_t begin = neighbours_.first[v], end = neighbours_.first[v + 1];
        if (begin == end) continue;
        row.assign(1, {v, 1.0});
        for (std::uint32_t i = begin; i < end; ++i)
            row.emplace_back(neighbours_.other[i], -1.0 / (end - begin));
        for (const auto& [j, a] : row)
            for (const auto& [k, b] : row)
                entries.push_back({j, k, smoothness_ * a * b});
    }
}

Points GeometryOptimizer::right_hand_side(const Points& x) const
{
    Points b = anchor_ * start_ + regularizer_target();
    for (FaceId f = 0; f < mesh_.mesh.face.size(); ++f) {
        const auto& face = mesh_.mesh.face[f];
        const PlaneId p = mesh_.face_plane[f];
        Eigen::Matrix3d target;
        for (int k = 0; k < 3; ++k) {
            const Eigen::Vector3d at = x.row(face[static_cast<std::size_t>(k)]);
            target.row(k) = at + face_pull_[f] * (mesh_.plane[p].project(at) - at);
        }
        const Eigen::Matrix3d pulled = mass_[f] * target;
        for (int k = 0; k < 3; ++k)
            b.row(face[static_cast<std::size_t>(k)]) += pulled.row(k);
    }
    for (VertexId v = 0; v < crease_weight_.size(); ++v)
        if (crease_weight_[v] > 0.0) b.row(v) += crease_weight_[v] * crease_target(v, x.row(v)).point.transpose();
    return b;
}

// lambda_r m' L^T L X0 for displacements.
Points GeometryOptimizer::regularizer_target() const
{
    Points target = Points::Zero(start_.rows(), 3);
    if (params_.regularizer == Regularizer::Laplacian) return target;
    for (VertexId v = 0; v < crease_weight_.size(); ++v) {
        const std::uint32_t begin = neighbours_.first[v], end = neighbours_.first[v + 1];
        if (begin == end) continue;
        const double share = 1.0 / (end - begin);
        Eigen::RowVector3d row = start_.row(v);
        for (std::uint32_t i = begin; i < end; ++i)
            row -= share * start_.row(neighbours_.other[i]);
        target.row(v) += smoothness_ * row;
        for (std::uint32_t i = begin; i < end; ++i)
            target.row(neighbours_.other[i]) -= smoothness_ * share * row;
    }
    return target;
}

Points GeometryOptimizer::limited(Points x) const
{
    for (Eigen::Index v = 0; v < x.rows(); ++v) {
        const Eigen::RowVector3d move = x.row(v) - start_.row(v);
        const double length = move.norm();
        if (length > params_.max_move) x.row(v) = start_.row(v) + params_.max_move / length * move;
    }
    return x;
}

} // namespace

Eigen::Matrix3d face_mass(double texels)
{
    return texels / 12.0 * (Eigen::Matrix3d::Identity() + Eigen::Matrix3d::Ones());
}

PlaneMesh optimize_geometry(const PlaneMesh& mesh, const std::vector<Plane>& planes,
                            const OptimizeGeometryParams& params)
{
    check_planes(mesh, planes);
    PlaneMesh result = mesh;
    result.plane = oriented_like(mesh.plane, planes);
    result.mesh.normal.clear();
    if (mesh.mesh.face.empty()) return result;
    const Points x = GeometryOptimizer(result, params).run();
    for (VertexId v = 0; v < result.mesh.position.size(); ++v)
        result.mesh.position[v] = x.row(v).transpose().cast<float>();
    const auto held =
        hold_back_flips(result, mesh.mesh.position, {.min_cosine = std::cos(radians(params.max_deviation))});
    log_info(fmt::format("{} of {} vertices were held back so that no face turns over, folds or shrinks to a line",
                         held, x.rows()));
    separate_parts(result, params.max_plane_rms, PlaneParts::OneSided);
    result.vertex_class = classify_vertices(result.mesh, result.face_plane);
    return result;
}

} // namespace quoin
