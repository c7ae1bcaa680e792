#pragma once

#include "geometry/moments.h"
#include "geometry/plane.h"
#include "mesh/triangle_mesh.h"

#include <array>
#include <vector>

namespace quoin {

// Inner: all faces of one plane, not on the mesh border. Border: on a curve between exactly two planes, or on the mesh
// border inside one plane. Corner: three or more planes, the end of a curve, or non-manifold.
enum class VertexClass : std::uint8_t { Inner = 0, Border = 1, Corner = 2 };

// A mesh whose every face belongs to one plane. `moments` are those of the dense cluster the plane was fitted to, kept
// through merging and simplification (about the world origin); `plane` normals point to the side the faces face.
struct PlaneMesh {
    TriangleMesh mesh;
    std::vector<PlaneId> face_plane;       // F, < plane.size()
    std::vector<Plane> plane;              // P
    std::vector<Moments> moments;          // P
    std::vector<VertexClass> vertex_class; // V
};

// What the faces around a vertex and the edges on borders that end there say of it.
struct BorderUse {
    std::array<PlaneId, 2> plane{kNoPlane, kNoPlane};
    int edges = 0; // between planes and on the mesh border
    bool mesh_border = false;
    bool irregular = false; // more than two planes, or an edge of three or more faces

    void see(PlaneId plane);
    // An edge between two planes; the second is kNoPlane on the mesh border.
    void add_edge(PlaneId here, PlaneId there);
    VertexClass vertex_class() const;
};

// Classes of all vertices from the planes of their faces. opposite: opposite_half_edges(mesh).
std::vector<VertexClass> classify_vertices(const TriangleMesh& mesh, const std::vector<PlaneId>& face_plane);
std::vector<VertexClass> classify_vertices(const TriangleMesh& mesh, const std::vector<PlaneId>& face_plane,
                                           const std::vector<std::uint32_t>& opposite);

} // namespace quoin
