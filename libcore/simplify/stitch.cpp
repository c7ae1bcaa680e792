#include "simplify/stitch.h"

#include "base/parallel.h"
#include "mesh/adjacency.h"

#include <algorithm>
#include <tuple>

namespace quoin {
namespace {

constexpr std::size_t kStitchGrain = 1 << 14; // [half-edges]

struct EdgeUse {
    VertexId low = 0, high = 0;
    PlaneId plane = 0;
    FaceId face = 0;
    bool same_edge(const EdgeUse& other) const { return low == other.low && high == other.high; }
};

// Those of edges with three or more faces.
std::vector<EdgeUse> sorted_crowded_edges(const TriangleMesh& mesh, const std::vector<PlaneId>& face_plane)
{
    const auto opposite = opposite_half_edges(mesh);
    std::vector<EdgeUse> edges;
    for (const auto h : parallel_select<std::uint32_t>(
             opposite.size(), kStitchGrain, [&](std::size_t i) { return opposite[i] == kNonManifoldEdge; })) {
        const auto [low, high] = std::minmax(mesh.face[h / 3][h % 3], mesh.face[h / 3][(h % 3 + 1) % 3]);
        edges.push_back({low, high, face_plane[h / 3], h / 3});
    }
    std::sort(edges.begin(), edges.end(), [](const EdgeUse& a, const EdgeUse& b) {
        return std::tie(a.low, a.high, a.plane, a.face) < std::tie(b.low, b.high, b.plane, b.face);
    });
    return edges;
}

Rgb8 mean_color(const TriangleMesh& mesh, std::initializer_list<VertexId> vertices)
{
    Rgb8 mean{};
    for (std::size_t c = 0; c < 3; ++c) {
        std::size_t sum = 0;
        for (const VertexId v : vertices)
            sum += mesh.color[v][c];
        mean[c] = static_cast<std::uint8_t>(sum / vertices.size());
    }
    return mean;
}

VertexId add_middle(TriangleMesh& mesh, std::initializer_list<VertexId> vertices)
{
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const VertexId v : vertices)
        sum += mesh.position[v].cast<double>();
    mesh.position.push_back((sum / static_cast<double>(vertices.size())).cast<float>());
    if (!mesh.color.empty()) mesh.color.push_back(mean_color(mesh, vertices));
    return static_cast<VertexId>(mesh.position.size() - 1);
}

void add_face(PlaneMesh& mesh, const Face& face, PlaneId plane)
{
    mesh.mesh.face.push_back(face);
    mesh.face_plane.push_back(plane);
}

// Both faces of the plane on the edge ab become two each. Faces may have been split before, so they are looked for.
void split_edge(PlaneMesh& mesh, VertexId a, VertexId b, std::vector<FaceId>& faces_of_plane)
{
    const VertexId middle = add_middle(mesh.mesh, {a, b});
    const std::size_t count = faces_of_plane.size();
    for (std::size_t i = 0; i < count; ++i) {
        Face& face = mesh.mesh.face[faces_of_plane[i]];
        const auto has = [&](VertexId v) { return std::find(face.begin(), face.end(), v) != face.end(); };
        if (!has(a) || !has(b)) continue;
        Face half = face;
        std::replace(face.begin(), face.end(), b, middle);
        std::replace(half.begin(), half.end(), a, middle);
        faces_of_plane.push_back(static_cast<FaceId>(mesh.mesh.face.size()));
        add_face(mesh, half, mesh.face_plane[faces_of_plane[i]]);
    }
}

struct Chord {
    PlaneId plane = 0;
    VertexId a = 0, b = 0;
    auto operator<=>(const Chord&) const = default;
};

// Edges inside planes that are not the only ones to have drawn them; the first plane keeps its, unless a border is
// there.
std::vector<Chord> surplus_chords(const PlaneMesh& mesh)
{
    const auto edges = sorted_crowded_edges(mesh.mesh, mesh.face_plane);
    std::vector<Chord> surplus;
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
        for (end = begin + 1; end < edges.size() && edges[end].same_edge(edges[begin]);)
            ++end;
        std::vector<Chord> chords;
        bool others = false;
        for (std::size_t i = begin; i < end; ++i) {
            const bool chord = i + 1 < end && edges[i + 1].plane == edges[i].plane;
            if (chord)
                chords.push_back({edges[i++].plane, edges[begin].low, edges[begin].high});
            else
                others = true;
        }
        if (!chords.empty()) surplus.insert(surplus.end(), chords.begin() + (others ? 0 : 1), chords.end());
    }
    std::sort(surplus.begin(), surplus.end());
    return surplus;
}

std::vector<FaceId> faces_of(const PlaneMesh& mesh, PlaneId plane)
{
    std::vector<FaceId> faces;
    for (FaceId f = 0; f < mesh.mesh.face.size(); ++f)
        if (mesh.face_plane[f] == plane) faces.push_back(f);
    return faces;
}

void split_repeated_faces(PlaneMesh& mesh)
{
    std::vector<std::pair<Face, FaceId>> faces;
    for (const FaceId f : faces_that_may_repeat(opposite_half_edges(mesh.mesh))) {
        Face ids = mesh.mesh.face[f];
        std::sort(ids.begin(), ids.end());
        faces.emplace_back(ids, f);
    }
    std::sort(faces.begin(), faces.end());
    for (std::size_t i = 1; i < faces.size(); ++i) {
        if (faces[i].first != faces[i - 1].first) continue;
        const FaceId f = faces[i].second;
        const auto [a, b, c] = mesh.mesh.face[f];
        const VertexId middle = add_middle(mesh.mesh, {a, b, c});
        mesh.mesh.face[f] = {a, b, middle};
        add_face(mesh, {b, c, middle}, mesh.face_plane[f]);
        add_face(mesh, {c, a, middle}, mesh.face_plane[f]);
    }
}

} // namespace

void split_shared_chords(PlaneMesh& mesh)
{
    const auto surplus = surplus_chords(mesh);
    for (std::size_t begin = 0, end = 0; begin < surplus.size(); begin = end) {
        auto faces = faces_of(mesh, surplus[begin].plane);
        for (end = begin; end < surplus.size() && surplus[end].plane == surplus[begin].plane; ++end)
            split_edge(mesh, surplus[end].a, surplus[end].b, faces);
    }
    split_repeated_faces(mesh);
}

} // namespace quoin
