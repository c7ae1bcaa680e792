// Which texels tell most of where the cameras are.
#pragma once

#include "alignment/observations.h"

namespace quoin {

// The best texels: in squares of `bucket` texels the part `selected` with the largest mean gradient, and `uniform` of
// all.
std::vector<std::uint8_t> select_texels(const AlignmentScene& scene, const AlignmentState& state, const Texels& texels,
                                        const Observations& observations, int level);

} // namespace quoin
