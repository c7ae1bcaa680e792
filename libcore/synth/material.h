// What surfaces look like: procedural materials and the pictures and words on them.
#pragma once

#include "image/image.h"

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace quoin {

enum class Pattern : std::uint8_t {
    Plaster,
    Wallpaper,
    Brick,
    Tiles,
    Planks,
    Wood,
    Carpet,
    Fabric,
    Cardboard,
    Paper,
    Metal,
    Sky
};

struct Material {
    Pattern pattern = Pattern::Plaster;
    Eigen::Vector3f first{0.7f, 0.7f, 0.7f};  // albedo, sRGB, 0..1
    Eigen::Vector3f second{0.5f, 0.5f, 0.5f}; // of joints, grain, motif
    std::uint32_t seed = 0;
    bool glows = false; // gives light and takes no shade
};

// Albedo (sRGB, 0..1) at a point of a surface; u to the right, v down, seen from the front [m].
Eigen::Vector3f albedo(const Material& material, const Eigen::Vector2d& uv);

// A picture glued onto a surface.
struct Decal {
    Eigen::Vector2d corner; // of its upper left [m]
    Eigen::Vector2d size;   // [m]
    ColorImage image;
};

enum class PosterStyle : std::uint8_t { Headline, EyeChart, Newspaper, Painting, Chart };
inline constexpr int kPosterStyles = 5;

// A picture of width x height metres drawn with `pixel` metres a pixel. Deterministic in its arguments.
ColorImage draw_poster(PosterStyle style, const Eigen::Vector2d& size, double pixel, std::uint32_t seed);
// Words that fill a rectangle on a background; `upright` false turns them by 90 degrees, as on the spine of a book.
struct Label {
    std::string text;
    Rgb8 ink{20, 20, 20};
    Rgb8 paper{230, 225, 210};
    bool upright = true;
};
ColorImage draw_label(const Label& label, const Eigen::Vector2d& size, double pixel);

} // namespace quoin
