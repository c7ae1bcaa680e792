#include "metrics/seen_surface.h"

#include "base/parallel.h"
#include "base/progress.h"
#include "metrics/keyframe_sight.h"

#include <algorithm>

namespace quoin {
namespace {

// Keyframes whose results are in memory at a time.
constexpr std::size_t kBatch = 32;

} // namespace

std::vector<std::uint8_t> seen_by_keyframes(std::span<const SurfaceSample> samples, const Evaluated& inputs,
                                            const EvaluateParams& params)
{
    const std::size_t count = inputs.keyframes->frame.size();
    std::vector<std::uint8_t> seen(samples.size(), 0);
    Progress progress("looking from keyframes", count);
    for (std::size_t first = 0; first < count; first += kBatch) {
        std::vector<std::vector<std::uint8_t>> by_keyframe(std::min(kBatch, count - first));
        parallel_for(by_keyframe.size(), [&](std::size_t i) {
            const KeyframeSight sight(inputs, first + i, params);
            by_keyframe[i].resize(samples.size());
            std::ranges::transform(samples, by_keyframe[i].begin(),
                                   [&](const SurfaceSample& s) { return sight.look(s) ? 1 : 0; });
            progress.step();
        });
        for (const auto& sees : by_keyframe)
            for (std::size_t s = 0; s < seen.size(); ++s)
                seen[s] |= sees[s];
    }
    return seen;
}

} // namespace quoin
