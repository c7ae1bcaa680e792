// Colours of all texels from the photographs.
#pragma once

#include "bake/atlas.h"
#include "bake/bake_texture.h"
#include "bake/texel_colors.h"

#include <vector>

namespace quoin {

// One per chart; texels that no view sees stay TexelSource::Empty. What none sees by the safe margins comes
// from the best that does by the least ones. Keyframes are used twice, a few at a time: once to
// judge them, once for their colours; what does not fit in memory is read twice.
std::vector<ChartColors> blend_views(const Atlas& atlas, const BakeInput& input, const BakeTextureParams& params);

} // namespace quoin
