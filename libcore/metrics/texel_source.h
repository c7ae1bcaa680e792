#pragma once

#include "render/textured.h"

#include <algorithm>
#include <cmath>

namespace quoin {

// The source of the texel that a point lies in.
inline TexelSource source_at(const TexturedModel& model, FaceId face, const Eigen::Vector2d& texel)
{
    const Image<std::uint8_t>& source = model.pages()[model.mesh().face_page[face]].source;
    if (source.empty()) return TexelSource::Empty;
    const int x = std::clamp(static_cast<int>(std::lround(texel.x())), 0, source.width - 1),
              y = std::clamp(static_cast<int>(std::lround(texel.y())), 0, source.height - 1);
    return static_cast<TexelSource>(source.at(x, y));
}

} // namespace quoin
