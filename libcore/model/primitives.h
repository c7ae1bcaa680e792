// The mesh as renderers want it: one piece per atlas page, and a vertex for every place where texture or plane changes.
#pragma once

#include "model/model.h"

#include <vector>

namespace quoin {

struct Primitive {
    std::uint32_t page = 0;
    std::vector<Eigen::Vector3f> position; // model frame [m]
    std::vector<Eigen::Vector3f> normal;   // unit; empty when not asked for
    std::vector<Eigen::Vector2f> uv;       // empty without texture
    std::vector<Rgb8> color;               // of the plane or the vertex; empty with texture or when nothing has colour
    std::vector<VertexId> vertex;          // of the model's mesh
    std::vector<Face> face;                // into the arrays above
    std::vector<FaceId> source;            // the model's face of each
};

// Faces keep their order; faces with a repeated vertex are left out. Normals are area-weighted means over the faces of
// one plane around a vertex, so creases between planes stay sharp.
std::vector<Primitive> make_primitives(const Model& model, bool with_normals);

} // namespace quoin
