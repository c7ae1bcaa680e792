// Views of a coloured model, unlit: what a viewer shows of it.
#pragma once

#include "mesh/textured_mesh.h"
#include "render/rasterize.h"

#include <Eigen/Core>
#include <vector>

namespace quoin {

// One level of a texture for every factor of two, decoded.
struct TexturePyramid {
    std::vector<ColorImage> level;
    Image<std::uint8_t> source; // TexelSource of level 0; empty if the page has none
};

// A textured mesh, ready to be looked at. Throws InputError when a page is no image of its size.
class TexturedModel {
public:
    explicit TexturedModel(const TexturedMesh& mesh);
    const TexturedMesh& mesh() const { return *mesh_; }
    const std::vector<TexturePyramid>& pages() const { return pages_; }
    // Texture coordinates of a point of a face by its barycentric weights, in texels of level 0 (centres at integers).
    Eigen::Vector2d texel(FaceId face, const Eigen::Vector3d& weights) const;
    // Bilinear within a level, linear between levels; `footprint` is the width of a pixel in texels. 0..255.
    Eigen::Vector3f sample(FaceId face, const Eigen::Vector2d& texel, double footprint) const;

private:
    const TexturedMesh* mesh_;
    std::vector<TexturePyramid> pages_;
};

struct RenderedView {
    ColorImage color;   // black where there is nothing
    DepthImage depth;   // z [m]; 0 where there is nothing
    Image<FaceId> face; // kNoFace where there is nothing
};

// `supersampling`: samples along each side of a pixel; depth and face are those of the first sample of a pixel that
// shows something. Serial: callers render views in parallel.
RenderedView render_textured(const TexturedModel& model, const Camera& camera, const Rigid& camera_from_world,
                             int supersampling = 1);
// A mesh with colours at its vertices; grey where it has none.
RenderedView render_colored(const TriangleMesh& mesh, const Camera& camera, const Rigid& camera_from_world,
                            int supersampling = 1);

// Barycentric weights of the point in which the ray through a pixel meets the plane of a triangle.
Eigen::Vector3d barycentric_on_ray(const std::array<Eigen::Vector3d, 3>& corner_camera, const Eigen::Vector3d& ray);

} // namespace quoin
