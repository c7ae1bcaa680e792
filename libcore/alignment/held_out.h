// Texels that the solver does not see, by which its result is judged.
#pragma once

#include "alignment/observations.h"
#include "scan/alignment.h"

#include <optional>

namespace quoin {

// Marks params.held_out of the texels: whole squares of a plane, chosen by a fixed hash. The same places at every
// spacing.
std::vector<std::uint8_t> held_out_texels(const Texels& texels, const OptimizeTextureParams& params);

// A state, and which frame sees which texel under it.
struct SeenState {
    AlignmentState& state; // its exposures are estimated anew, so that they alone decide nothing
    const Observations& observations;
};

// How far the views of held-out texels are from one colour, where a frame sees a texel under both states; the input is
// to be kept if they are farther after than before, by params.certainty standard errors. None where there are no such
// views.
std::optional<HeldOutScores> judge(const AlignmentScene& scene, const Texels& texels, const SeenState& input,
                                   const SeenState& optimized);

} // namespace quoin
