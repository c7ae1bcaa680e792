// What every writer of this folder works on: the mesh in the model frame with all its optional companions.
#pragma once

#include "geometry/rigid.h"
#include "mesh/plane_mesh.h"
#include "mesh/textured_mesh.h"

#include <optional>
#include <string>
#include <vector>

namespace quoin {

struct CameraPose {
    double time = 0.0; // [s]
    Rigid model_from_camera = Rigid::Identity();
};

struct ModelPage {
    std::string file; // "model_0.jpg"
    std::string mime; // "image/jpeg"
    const AtlasPage* page = nullptr;
};

struct Model {
    TriangleMesh mesh;                     // model frame; normals are those that files get, or none
    std::vector<PlaneId> face_plane;       // F or empty
    std::vector<Plane> plane;              // model frame
    std::vector<Rgb8> plane_color;         // to tell planes apart
    const TexturedMesh* texture = nullptr; // for its uv, corner_uv and face_page
    std::vector<ModelPage> page;
    std::vector<CameraPose> trajectory;
    Rigid model_from_world = Rigid::Identity();
    bool levelled = false;
    std::optional<PlaneId> floor;
    std::string generator; // "Quoin 0.1.0"

    bool has_planes() const { return !face_plane.empty(); }
    bool has_texture() const { return texture != nullptr; }
};

} // namespace quoin
