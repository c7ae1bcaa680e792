#include "mesh/hygiene.h"

#include "base/parallel.h"
#include "geometry/union_find.h"
#include "mesh/adjacency.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <tuple>

namespace quoin {
namespace {

constexpr std::size_t kShapeGrain = 1 << 14;

struct Edge {
    VertexId low = 0, high = 0;
    std::uint32_t half_edge = 0;
    bool same_ends(const Edge& other) const { return low == other.low && high == other.high; }
};

bool repeats_vertex(const Face& face) { return face[0] == face[1] || face[1] == face[2] || face[2] == face[0]; }

// Every half-edge of faces with three vertices, sorted by its ends.
std::vector<Edge> sorted_edges(const TriangleMesh& mesh)
{
    std::vector<Edge> edges;
    edges.reserve(3 * mesh.face.size());
    for (FaceId f = 0; f < mesh.face.size(); ++f) {
        if (repeats_vertex(mesh.face[f])) continue;
        for (std::uint32_t k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax(mesh.face[f][k], mesh.face[f][(k + 1) % 3]);
            edges.push_back({low, high, 3 * f + k});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::tie(a.low, a.high, a.half_edge) < std::tie(b.low, b.high, b.half_edge);
    });
    return edges;
}

// Calls visit(first, last) for the half-edges of every edge.
template <class Visit>
void for_each_edge(const std::vector<Edge>& edges, const Visit& visit)
{
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
        for (end = begin + 1; end < edges.size() && edges[end].same_ends(edges[begin]);)
            ++end;
        visit(&edges[begin], &edges[begin] + (end - begin));
    }
}

bool runs_upwards(const TriangleMesh& mesh, const Edge& edge)
{
    return mesh.face[edge.half_edge / 3][edge.half_edge % 3] == edge.low;
}

void count_edges(const TriangleMesh& mesh, const std::vector<Edge>& edges, const HygieneLimits& limits, Hygiene& found)
{
    std::ptrdiff_t count = 0;
    for_each_edge(edges, [&](const Edge* first, const Edge* last) {
        ++count;
        const auto faces = last - first;
        if (faces > 2) ++found.non_manifold_edges;
        if (faces == 1) {
            ++found.border_edges;
            found.border_length += (mesh.position[first->high] - mesh.position[first->low]).cast<double>().norm();
        }
        if (faces != 2) return;
        const bool inconsistent = runs_upwards(mesh, first[0]) == runs_upwards(mesh, first[1]);
        if (inconsistent) ++found.inconsistent_edges;
        const double cosine = face_normal(mesh, first[0].half_edge / 3).dot(face_normal(mesh, first[1].half_edge / 3));
        if ((inconsistent ? -cosine : cosine) < limits.folded_cosine) ++found.folded_pairs;
    });
    found.euler_characteristic -= count;
}

void count_face_shapes(const TriangleMesh& mesh, const HygieneLimits& limits, Hygiene& found)
{
    struct Shapes {
        std::size_t flat = 0, slivers = 0;
    };
    const auto classify = [&](std::size_t begin, std::size_t end) {
        Shapes shapes;
        for (auto f = static_cast<FaceId>(begin); f < end; ++f) {
            double longest = 0.0;
            for (int k = 0; k < 3; ++k)
                longest = std::max(longest, (corner(mesh, f, (k + 1) % 3) - corner(mesh, f, k)).norm());
            const double height = longest > 0.0 ? area_vector(mesh, f).norm() / longest : 0.0;
            if (!(height > limits.zero_height))
                ++shapes.flat;
            else if (height < limits.sliver_ratio * longest)
                ++shapes.slivers;
        }
        return shapes;
    };
    const auto total = parallel_reduce(mesh.face.size(), kShapeGrain, Shapes{}, classify, [](Shapes a, Shapes b) {
        return Shapes{a.flat + b.flat, a.slivers + b.slivers};
    });
    found.zero_area_faces = total.flat;
    found.slivers = total.slivers;
}

std::size_t count_duplicates(const TriangleMesh& mesh)
{
    std::vector<Face> faces = mesh.face;
    for (auto& face : faces)
        std::sort(face.begin(), face.end());
    std::sort(faces.begin(), faces.end());
    return static_cast<std::size_t>(faces.end() - std::unique(faces.begin(), faces.end()));
}

// Fans around a vertex: corners joined over edges of any number of faces. A vertex with more fans than one is a
// bow-tie.
void count_fans(const TriangleMesh& mesh, const std::vector<Edge>& edges, Hygiene& found)
{
    UnionFind corners(3 * mesh.face.size());
    const auto corner_at = [&](FaceId f, VertexId v) {
        const auto& face = mesh.face[f];
        return 3 * f + static_cast<std::uint32_t>(std::find(face.begin(), face.end(), v) - face.begin());
    };
    for_each_edge(edges, [&](const Edge* first, const Edge* last) {
        for (const Edge* other = first + 1; other < last; ++other) {
            for (const VertexId v : {first->low, first->high}) {
                const auto a = corners.find(corner_at(first->half_edge / 3, v)),
                           b = corners.find(corner_at(other->half_edge / 3, v));
                if (a != b) corners.join(std::min(a, b), std::max(a, b));
            }
        }
    });
    std::vector<std::uint8_t> fans(mesh.position.size(), 0);
    for (std::uint32_t c = 0; c < 3 * mesh.face.size(); ++c) {
        if (repeats_vertex(mesh.face[c / 3]) || !corners.is_root(c)) continue;
        auto& count = fans[mesh.face[c / 3][c % 3]];
        count = static_cast<std::uint8_t>(std::min(2, count + 1));
    }
    found.bow_tie_vertices = static_cast<std::size_t>(std::count(fans.begin(), fans.end(), 2));
    found.isolated_vertices = static_cast<std::size_t>(std::count(fans.begin(), fans.end(), 0));
    found.euler_characteristic += static_cast<std::ptrdiff_t>(mesh.position.size() - found.isolated_vertices);
    found.euler_characteristic +=
        std::count_if(mesh.face.begin(), mesh.face.end(), [](const Face& face) { return !repeats_vertex(face); });
}

std::size_t count_components(const TriangleMesh& mesh)
{
    const auto components = face_components(mesh);
    return components.empty() ? 0 : *std::max_element(components.begin(), components.end()) + 1;
}

// Sets of faces joined over edges inside one plane, less one a plane.
void count_planes(const PlaneMesh& mesh, Hygiene& found)
{
    UnionFind patches(mesh.mesh.face.size());
    for_each_edge(sorted_edges(mesh.mesh), [&](const Edge* first, const Edge* last) {
        for (const Edge* a = first; a < last; ++a) {
            for (const Edge* b = a + 1; b < last; ++b) {
                if (mesh.face_plane[a->half_edge / 3] != mesh.face_plane[b->half_edge / 3]) continue;
                const auto r = patches.find(a->half_edge / 3), s = patches.find(b->half_edge / 3);
                if (r != s) patches.join(std::min(r, s), std::max(r, s));
            }
        }
    });
    std::vector<std::size_t> count(mesh.plane.size(), 0);
    for (FaceId f = 0; f < mesh.mesh.face.size(); ++f) {
        if (patches.is_root(f)) ++count[mesh.face_plane[f]];
        if (face_normal(mesh.mesh, f).dot(mesh.plane[mesh.face_plane[f]].normal) < 0.0) ++found.flipped_faces;
    }
    for (const auto patches_of_plane : count) {
        if (patches_of_plane == 0) ++found.empty_planes;
        if (patches_of_plane > 1) ++found.disconnected_planes;
    }
}

} // namespace

Hygiene inspect(const TriangleMesh& mesh, const HygieneLimits& limits)
{
    Hygiene found;
    found.vertices = mesh.position.size();
    found.faces = mesh.face.size();
    const auto edges = sorted_edges(mesh);
    count_edges(mesh, edges, limits, found);
    count_fans(mesh, edges, found);
    count_face_shapes(mesh, limits, found);
    found.duplicate_faces = count_duplicates(mesh);
    found.components = count_components(mesh);
    return found;
}

Hygiene inspect(const PlaneMesh& mesh, const HygieneLimits& limits)
{
    Hygiene found = inspect(mesh.mesh, limits);
    count_planes(mesh, found);
    return found;
}

} // namespace quoin
