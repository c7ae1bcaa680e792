// Observations of one frame on one plane: they share a homography, so they are worked on together.
#pragma once

#include "alignment/observations.h"

namespace quoin {

struct ObservationRuns {
    std::vector<ObservationRun> run;           // by frame, then plane
    std::vector<std::uint32_t> first_of_frame; // K + 1
    std::vector<std::uint32_t> first_of_plane; // P + 1
    std::vector<std::uint32_t> of_plane;       // runs by plane, then frame
};
ObservationRuns runs_of(const Observations& observations, const Texels& texels);

} // namespace quoin
