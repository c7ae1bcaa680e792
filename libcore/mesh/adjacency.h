// Connectivity of a triangle mesh in flat arrays, by sorting edge keys: no hash per element.
#pragma once

#include "mesh/triangle_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace quoin {

// Half-edge h = 3 f + k runs from corner k of face f to corner k+1.
inline constexpr std::uint32_t kBorderEdge = 0xffffffffu;
inline constexpr std::uint32_t kNonManifoldEdge = 0xfffffffeu;

inline bool is_half_edge(std::uint32_t opposite) { return opposite != kBorderEdge && opposite != kNonManifoldEdge; }

// opposite[h]: the half-edge of the other face on the edge, whatever its direction; kBorderEdge on a mesh border,
// kNonManifoldEdge when three or more faces share the edge.
std::vector<std::uint32_t> opposite_half_edges(const TriangleMesh& mesh);

// Faces that may have the same vertices as others, ascending: these share all their edges. opposite:
// opposite_half_edges(mesh).
std::vector<FaceId> faces_that_may_repeat(const std::vector<std::uint32_t>& opposite);

// Faces around every vertex, ascending: faces of v are face[first[v]] .. face[first[v+1]-1].
struct VertexFaces {
    std::vector<std::uint32_t> first; // V + 1
    std::vector<FaceId> face;
    std::span<const FaceId> of(VertexId v) const { return {face.data() + first[v], first[v + 1] - first[v]}; }
};
VertexFaces vertex_faces(const TriangleMesh& mesh);

// Connected components over shared edges: a component id per face, ids in order of the first face.
std::vector<std::uint32_t> face_components(const TriangleMesh& mesh);

} // namespace quoin
