// Which texels tell most of where the cameras are.
#pragma once

#include "alignment/observations.h"

namespace quoin {

// The best texels: in squares of `bucket` texels the part `selected` with the largest mean gradient, and `uniform` of
// all.
std::vector<std::uint8_t> select_texels(const AlignmentScene& scene, const AlignmentState& state, const Texels& texels,
                                        const Observations& observations, int level);

// Texels that two frames or more see, and those among them whose mean gradient is `min_gradient` or more.
struct Textured {
    std::size_t seen = 0, textured = 0;
    bool is_at_most(double part) const { return static_cast<double>(textured) <= part * static_cast<double>(seen); }
};
Textured textured_texels(const AlignmentScene& scene, const AlignmentState& state, const Texels& texels,
                         const Observations& observations);

} // namespace quoin
