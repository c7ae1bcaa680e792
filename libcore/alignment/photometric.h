// The colour term E_c: a texel must look the same in every frame that sees it.
#pragma once

#include "alignment/runs.h"

namespace quoin {

// What frames show of their texels: the grey, not corrected by the exposure, 0..1; the place (X/Z, Y/Z) where the
// colour camera sees the texel; and the derivatives of the grey by it. A point outside the image takes the colour of
// its border, with no derivative: the energy keeps its set of terms.
struct GraySamples {
    std::vector<float> value, by_x, by_y, x, y; // of every observation
};

// Texels, and who sees them.
struct SampledTexels {
    const Texels& texels;
    const Observations& observations;
    const ObservationRuns& runs;
};
GraySamples sample_grays(const AlignmentScene& scene, const AlignmentState& state, const SampledTexels& sampled,
                         int level);

// Texel colours that minimise the robust cost: their means to begin with, then `rounds` of reweighting by Huber's
// weight at `delta`. Each round lowers the cost.
std::vector<float> texel_colors(const Observations& observations, const std::vector<float>& gray, double delta,
                                int rounds);

} // namespace quoin
