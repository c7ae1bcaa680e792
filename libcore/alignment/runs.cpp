#include "alignment/runs.h"

#include <numeric>

namespace quoin {
namespace {

void list_by_plane(ObservationRuns& runs, std::size_t planes)
{
    runs.first_of_plane.assign(planes + 1, 0);
    for (const ObservationRun& run : runs.run)
        ++runs.first_of_plane[run.plane + 1];
    std::partial_sum(runs.first_of_plane.begin(), runs.first_of_plane.end(), runs.first_of_plane.begin());
    runs.of_plane.resize(runs.run.size());
    auto next = runs.first_of_plane;
    for (std::uint32_t r = 0; r < runs.run.size(); ++r)
        runs.of_plane[next[runs.run[r].plane]++] = r;
}

} // namespace

ObservationRuns runs_of(const Observations& observations, const Texels& texels)
{
    ObservationRuns runs;
    runs.first_of_frame.push_back(0);
    for (std::uint32_t k = 0; k + 1 < observations.first_of_frame.size(); ++k) {
        for (std::uint32_t o = observations.first_of_frame[k]; o < observations.first_of_frame[k + 1]; ++o) {
            const PlaneId plane = texels.plane[observations.texel[o]];
            const bool starts = runs.run.size() == runs.first_of_frame.back() || runs.run.back().plane != plane;
            if (starts) runs.run.push_back({k, o, o, plane});
            runs.run.back().end = o + 1;
        }
        runs.first_of_frame.push_back(static_cast<std::uint32_t>(runs.run.size()));
    }
    list_by_plane(runs, texels.first_of_plane.size() - 1);
    return runs;
}

} // namespace quoin
