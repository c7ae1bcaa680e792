#pragma once

#include "bake/atlas.h"
#include "bake/bake_texture.h"
#include "bake/texel_colors.h"

#include <vector>

namespace quoin {

// Writes the charts' colours onto the pages and encodes them. Between the charts what is beside them continues, and the
// mean colour of the page fills the rest, so that small mip levels show nothing odd.
std::vector<AtlasPage> encode_pages(const Atlas& atlas, const std::vector<ChartColors>& colors,
                                    const BakeTextureParams& params);

} // namespace quoin
