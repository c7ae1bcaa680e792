#include "simplify/fold_pieces.h"

#include "simplify/collapse_mesh.h"

#include <cmath>

namespace quoin {
namespace {

constexpr double kFoldedCosine = -0.5; // between faces on one edge
// How bad a face without area and one that looks away are, in folded edges: the rim of a sheet may be one in the end.
constexpr int kZeroWeight = 4, kFlippedWeight = 2;

Eigen::Vector3d middle(const Triangle& t) { return (t[0] + t[1] + t[2]) / 3.0; }

double squared_distance_to_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b)
{
    const Eigen::Vector3d ab = b - a;
    const double length = ab.squaredNorm();
    const double t = length > 0.0 ? std::clamp((p - a).dot(ab) / length, 0.0, 1.0) : 0.0;
    return (p - a - t * ab).squaredNorm();
}

double squared_distance(const Eigen::Vector3d& p, const Triangle& t)
{
    const Eigen::Vector3d n = (t[1] - t[0]).cross(t[2] - t[0]);
    const auto inside = [&](std::size_t k) { return n.dot((t[(k + 1) % 3] - t[k]).cross(p - t[k])) >= 0.0; };
    if (n.squaredNorm() > 0.0 && inside(0) && inside(1) && inside(2))
        return std::pow(n.dot(p - t[0]), 2) / n.squaredNorm();
    return std::min({squared_distance_to_segment(p, t[0], t[1]), squared_distance_to_segment(p, t[1], t[2]),
                     squared_distance_to_segment(p, t[2], t[0])});
}

// Distance to the nearest of the pieces; one of at most `enough` is only an upper bound.
double distance(const Eigen::Vector3d& p, const TwoPieces& pieces, double enough)
{
    double least = std::numeric_limits<double>::infinity();
    for (const Pieces* list : {&pieces.inner, &pieces.outer})
        for (const Piece& piece : *list) {
            const double squared = squared_distance(p, piece.corner);
            if (squared >= least) continue;
            least = squared;
            if (std::sqrt(least) <= enough) return std::sqrt(least);
        }
    return std::sqrt(least);
}

bool is_corner(const Eigen::Vector3d& p, const TwoPieces& pieces)
{
    const auto has = [&](const Piece& piece) { return std::ranges::find(piece.corner, p) != piece.corner.end(); };
    return std::ranges::any_of(pieces.inner, has) || std::ranges::any_of(pieces.outer, has);
}

// Of faces that share an edge: do they run along it the same way, as where a patch of the mesh is turned over?
bool runs_same_way(const Face& a, const Face& b)
{
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t j = 0; j < 3; ++j)
            if (a[k] == b[j] && a[(k + 1) % 3] == b[(j + 1) % 3]) return true;
    return false;
}

bool is_folded(const Piece& a, const Piece& b)
{
    const double cosine = a.normal.dot(b.normal);
    if (std::abs(cosine) <= -kFoldedCosine || !shares_edge(a.vertex, b.vertex)) return false;
    return (runs_same_way(a.vertex, b.vertex) ? -cosine : cosine) < kFoldedCosine;
}

} // namespace

Piece::Piece(const Face& face, const Triangle& corners, PlaneId plane_id)
    : vertex(face), corner(corners), plane(plane_id), normal(triangle_shape(corners[0], corners[1], corners[2]).normal),
      flat(!has_area(corners))
{
}

int defects(const TwoPieces& pieces, const std::vector<Plane>& planes, int enough)
{
    const auto& [inner, outer] = pieces;
    int count = 0;
    for (const Piece& piece : inner) {
        if (piece.flat) count += kZeroWeight;
        if (piece.normal.dot(planes[piece.plane].normal) < 0.0) count += kFlippedWeight;
    }
    for (std::size_t i = 0; i < inner.size() && count <= enough; ++i) {
        for (std::size_t j = i + 1; j < inner.size(); ++j)
            count += is_folded(inner[i], inner[j]) ? 1 : 0;
        for (const Piece& piece : outer)
            count += is_folded(inner[i], piece) ? 1 : 0;
    }
    return count;
}

double area_of(const Pieces& pieces)
{
    double twice = 0.0;
    for (const Piece& piece : pieces)
        twice += (piece.corner[1] - piece.corner[0]).cross(piece.corner[2] - piece.corner[0]).norm();
    return 0.5 * twice;
}

double farthest(const Pieces& from, const TwoPieces& to, double enough)
{
    double most = 0.0;
    for (const Piece& piece : from) {
        for (const auto& corner : piece.corner)
            if (most <= enough && !is_corner(corner, to)) most = std::max(most, distance(corner, to, most));
        if (most <= enough) most = std::max(most, distance(middle(piece.corner), to, most));
    }
    return most;
}

} // namespace quoin
