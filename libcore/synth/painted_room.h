// The room as a camera sees it: triangles, the true texture of every surface, light baked in.
#pragma once

#include "synth/rays.h"

#include <vector>

namespace quoin {

// sRGB at every texel, with levels of half the size for filtering. Texel (0, 0) covers `corner` .. `corner` + texel
// [m].
struct SurfaceTexture {
    Eigen::Vector2d corner;
    double texel = 0.0; // [m]
    std::vector<ColorImage> levels;

    // Bilinear within a level, linear between levels; `texels` is the footprint's width in texels of level 0. 0..255.
    Eigen::Vector3f sample(const Eigen::Vector2d& uv, double texels) const;
};

struct PaintedRoom {
    Room room;
    std::vector<Facet> facets;
    RayScene rays;
    std::vector<SurfaceTexture> texture; // one per surface

    // The true colour of a point of a surface, 0..255.
    Eigen::Vector3f color_at(std::uint32_t surface, const Eigen::Vector2d& uv) const
    {
        return texture[surface].sample(uv, 1.0);
    }
};

// Casts the light (sky through the window, lamp, and what the rest of the room gives back, by distance) and bakes every
// surface at `texel` metres a texel. The colour does not depend on the view.
PaintedRoom paint_room(Room room, double texel);

} // namespace quoin
