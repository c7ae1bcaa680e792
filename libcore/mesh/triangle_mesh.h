#pragma once

#include "image/image.h"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace quoin {

using VertexId = std::uint32_t;
using FaceId = std::uint32_t;
using Face = std::array<VertexId, 3>; // counter-clockwise seen from the front (from inside the room)

struct TriangleMesh {
    std::vector<Eigen::Vector3f> position; // V [m], world
    std::vector<Face> face;                // F
    std::vector<Rgb8> color;               // V or empty
    std::vector<Eigen::Vector3f> normal;   // V or empty, unit
};

inline Eigen::Vector3d corner(const TriangleMesh& mesh, FaceId f, int k)
{
    return mesh.position[mesh.face[f][static_cast<std::size_t>(k)]].cast<double>();
}

// Twice the area along the normal, and the area [m^2].
Eigen::Vector3d area_vector(const TriangleMesh& mesh, FaceId f);
double face_area(const TriangleMesh& mesh, FaceId f);
Eigen::Vector3d face_normal(const TriangleMesh& mesh, FaceId f); // unit, or zero for a face without area

} // namespace quoin
