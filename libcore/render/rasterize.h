// Depth and face-id rasteriser: what a camera sees of a mesh.
#pragma once

#include "geometry/camera.h"
#include "geometry/rigid.h"
#include "image/image.h"
#include "mesh/triangle_mesh.h"

namespace quoin {

inline constexpr FaceId kNoFace = 0xffffffffu;

struct Visibility {
    Image<FaceId> face; // nearest face of every pixel; kNoFace where there is none
    DepthImage depth;   // its z [m]; 0 where there is none
};

struct RasterizeOptions {
    double near_plane = 0.05; // [m]; triangles are clipped against it, not dropped: walls pass behind the camera
    bool cull_back_faces = false;
};

// Renders by scan lines with a z-buffer; on equal depth the smaller face id wins. Serial: callers run cameras in
// parallel.
Visibility rasterize(const TriangleMesh& mesh, const Camera& camera, const Rigid& camera_from_world,
                     const RasterizeOptions& options = {});

} // namespace quoin
