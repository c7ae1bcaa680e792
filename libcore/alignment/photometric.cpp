#include "alignment/photometric.h"

#include "alignment/frame_picture.h"
#include "base/parallel.h"

#include <algorithm>
#include <array>

namespace quoin {
namespace {

constexpr std::size_t kColorGrain = 4096;
float mean(const std::vector<float>& view)
{
    Floats total{};
    for (std::size_t i = 0; i < view.size(); i += kFloats)
        total += load_part(&view[i], view.size() - i);
    return sum(total) / static_cast<float>(view.size());
}

// Then Huber's weights are all one.
bool all_within(const std::vector<float>& view, float center, float delta)
{
    Floats beyond{};
    for (std::size_t i = 0; i < view.size(); i += kFloats) {
        const Floats size = first_of(size_of(load_part(&view[i], view.size() - i) - center), view.size() - i);
        beyond += size > delta ? size : Floats{};
    }
    return sum(beyond) == 0.0f;
}

// Of a texel's views, weighted by Huber's weight at `delta` about `center`.
float weighted_mean(const std::vector<float>& view, float center, float delta)
{
    Floats total{}, weights{};
    for (std::size_t i = 0; i < view.size(); i += kFloats) {
        const Floats value = load_part(&view[i], view.size() - i);
        const Floats size = size_of(value - center), weight = delta / (size > delta ? size : each(delta));
        const Floats counted = first_of(weight, view.size() - i);
        total += counted * value;
        weights += counted;
    }
    return static_cast<float>(sum(total) / sum(weights));
}

float robust_mean(const std::vector<float>& view, float delta, int rounds)
{
    float center = mean(view);
    if (all_within(view, center, delta)) return center;
    for (int round = 0; round < rounds; ++round)
        center = weighted_mean(view, center, delta);
    return center;
}

// Observations that have been placed, but not sampled yet.
class Pending {
public:
    Pending(GraySamples& samples, const FramePicture& picture) : samples_(samples), picture_(picture) {}

    void add(const FramePicture::Place& place, std::size_t first, std::size_t count)
    {
        place_[size_] = place;
        part_[size_++] = {first, count};
        if (size_ == kPlaces) flush();
    }
    void flush()
    {
        for (std::size_t i = 0; i < size_; ++i) {
            const auto [o, count] = part_[i];
            const SampleLanes s = picture_.sample(place_[i]);
            store_part(s.value, &samples_.value[o], count);
            store_part(s.by_x, &samples_.by_x[o], count);
            store_part(s.by_y, &samples_.by_y[o], count);
            store_part(s.x, &samples_.x[o], count);
            store_part(s.y, &samples_.y[o], count);
        }
        size_ = 0;
    }

private:
    struct Part {
        std::size_t first, count; // of observations
    };
    GraySamples& samples_;
    const FramePicture& picture_;
    Places place_;
    std::array<Part, kPlaces> part_;
    std::size_t size_ = 0;
};

void sample_frame(GraySamples& samples, const AlignmentScene& scene, const AlignmentState& state, std::size_t k,
                  const SampledTexels& sampled, int level)
{
    const FramePicture picture = frame_picture(scene, state, k, level);
    Pending pending(samples, picture);
    for (std::uint32_t r = sampled.runs.first_of_frame[k]; r < sampled.runs.first_of_frame[k + 1]; ++r) {
        const ObservationRun& run = sampled.runs.run[r];
        const auto projection = picture.projection(state.plane[run.plane]);
        for (std::size_t o = run.begin; o < run.end; o += kFloats) {
            const Ints texel = load_part(&sampled.observations.texel[o], run.end - o);
            pending.add(picture.place(projection, sampled.texels.p_world, texel), o, run.end - o);
        }
    }
    pending.flush();
}

} // namespace

GraySamples sample_grays(const AlignmentScene& scene, const AlignmentState& state, const SampledTexels& sampled,
                         int level)
{
    GraySamples samples;
    for (auto* values : {&samples.value, &samples.by_x, &samples.by_y, &samples.x, &samples.y})
        values->resize(sampled.observations.size());
    parallel_for(scene.frames(), [&](std::size_t k) { sample_frame(samples, scene, state, k, sampled, level); });
    return samples;
}

std::vector<float> texel_colors(const Observations& observations, const std::vector<float>& gray, double delta,
                                int rounds)
{
    const std::size_t texels = observations.first_of_texel.size() - 1;
    std::vector<float> color(texels, 0.0f);
    parallel_chunks(texels, kColorGrain, [&](std::size_t begin, std::size_t end) {
        std::vector<float> view;
        for (std::size_t t = begin; t < end; ++t) {
            const std::uint32_t first = observations.first_of_texel[t];
            view.resize(observations.first_of_texel[t + 1] - first);
            for (std::size_t i = 0; i < view.size(); ++i)
                view[i] = gray[observations.of_texel[first + i]];
            if (!view.empty()) color[t] = robust_mean(view, static_cast<float>(delta), rounds);
        }
    });
    return color;
}

} // namespace quoin
