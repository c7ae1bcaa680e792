// Which texels one frame sees.
#pragma once

#include "alignment/samples.h"
#include "alignment/scene.h"

#include <vector>

namespace quoin {

inline constexpr int kRasterLevel = 1; // visibility is rendered at half the size: its edges are dilated anyway

// Coordinates of all texels, each by itself [m], by plane.
struct TexelLanes {
    std::vector<float> x, y, z;
    std::vector<TexelId> first_of_plane; // P + 1
};
TexelLanes texel_lanes(const Texels& texels);

// Texels that the colour camera of frame k sees at a pyramid level, ascending.
std::vector<TexelId> visible_texels(const AlignmentScene& scene, const AlignmentState& state, std::size_t k, int level,
                                    const TexelLanes& texels);

} // namespace quoin
