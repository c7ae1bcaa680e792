// The colour term E_c: a texel must look the same in every frame that sees it.
#pragma once

#include "alignment/runs.h"

namespace quoin {

// What SampleLanes tell, of every observation.
struct GraySamples {
    std::vector<float> value, by_x, by_y, x, y;
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
