#pragma once

#include "mesh/plane_mesh.h"

#include <cstddef>
#include <vector>

namespace quoin {

// Where a texel's colour comes from. Gutter: from the chart beside it; no look-up on a face in full size reads it.
enum class TexelSource : std::uint8_t { Empty = 0, Photograph = 1, DenseMesh = 2, Filled = 3, Gutter = 4 };

struct AtlasPage {
    int width = 0, height = 0;     // [px]
    std::vector<std::byte> image;  // encoded (JPEG or PNG), sRGB
    std::vector<std::byte> source; // encoded 8-bit PNG of TexelSource
};

// uv: (0,0) is the top left corner of the page's first texel, (1,1) the bottom right corner of its last one (glTF).
struct TexturedMesh {
    PlaneMesh planes;
    std::vector<Eigen::Vector2f> uv;                     // C
    std::vector<std::array<std::uint32_t, 3>> corner_uv; // F, into uv
    std::vector<std::uint32_t> face_page;                // F, into page
    std::vector<AtlasPage> page;
};

} // namespace quoin
