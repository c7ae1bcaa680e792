#include "alignment/observations.h"

#include "alignment/sight.h"
#include "base/parallel.h"
#include "render/rasterize.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <span>

namespace quoin {
namespace {

// Lists by frame and by texel from the visible texels of every frame; texels for which `keep` is 0 are left out, others
// get the number `renumbered`.
Observations listed(const std::vector<std::vector<TexelId>>& visible, const std::vector<std::uint8_t>& keep,
                    const std::vector<TexelId>& renumbered)
{
    Observations result;
    result.first_of_frame.assign(visible.size() + 1, 0);
    const auto is_kept = [&](TexelId t) { return keep[t] != 0; };
    parallel_for(visible.size(), [&](std::size_t k) {
        result.first_of_frame[k + 1] = static_cast<std::uint32_t>(std::ranges::count_if(visible[k], is_kept));
    });
    std::partial_sum(result.first_of_frame.begin(), result.first_of_frame.end(), result.first_of_frame.begin());
    result.texel.resize(result.first_of_frame.back());
    result.frame.resize(result.texel.size());
    parallel_for(visible.size(), [&](std::size_t k) {
        std::size_t o = result.first_of_frame[k];
        for (const TexelId t : visible[k]) {
            if (!is_kept(t)) continue;
            result.texel[o] = renumbered[t];
            result.frame[o++] = static_cast<std::uint32_t>(k);
        }
    });
    const std::size_t texel_count = renumbered.empty() ? 0 : renumbered.back() + std::size_t{1};
    result.first_of_texel.assign(texel_count + 1, 0);
    for (const TexelId t : result.texel)
        ++result.first_of_texel[t + 1];
    std::partial_sum(result.first_of_texel.begin(), result.first_of_texel.end(), result.first_of_texel.begin());
    result.of_texel.resize(result.texel.size());
    auto next = result.first_of_texel;
    for (std::uint32_t o = 0; o < result.texel.size(); ++o)
        result.of_texel[next[result.texel[o]]++] = o;
    return result;
}

DepthSample sample_depth(const AlignmentScene& scene, const KeyframeImages& images, const Visibility& seen, int x,
                         int y)
{
    const double z = images.depth.at(x, y);
    const int u = x >> kRasterLevel, v = y >> kRasterLevel;
    if (z < scene.params.min_depth || z > scene.params.max_depth) return {};
    if (!seen.face.contains(u, v) || seen.face.at(u, v) == kNoFace) return {};
    const double sigma = scene.depth_sigma(z);
    if (std::abs(seen.depth.at(u, v) - z) > std::max(scene.params.depth_gate, 3.0 * sigma)) return {};
    const Vector3 p = scene.depth_camera.ray({x, y}) * z;
    return {p.cast<float>(), scene.mesh.face_plane[seen.face.at(u, v)], static_cast<float>(1.0 / sigma)};
}

std::vector<DepthSample> sample_frame(const AlignmentScene& scene, const AlignmentState& state, std::size_t k)
{
    const KeyframeImages& images = scene.images[k];
    std::vector<DepthSample> samples;
    if (images.depth.empty()) return samples;
    const Rigid& camera_from_world = state.camera_from_world[k];
    const Visibility seen = rasterize(scene.mesh.mesh, scene.depth_camera.at_level(kRasterLevel), camera_from_world);
    const int stride = scene.params.depth_stride;
    for (int y = stride / 2; y < images.depth.height; y += stride)
        for (int x = stride / 2; x < images.depth.width; x += stride) {
            const DepthSample sample = sample_depth(scene, images, seen, x, y);
            if (sample.plane == kNoPlane) continue;
            const Vector3 normal = camera_from_world.linear() * state.plane[sample.plane].normal;
            const Vector3 p = sample.p_camera.cast<double>();
            if (-normal.dot(p) >= scene.params.min_cosine * p.norm()) samples.push_back(sample);
        }
    return samples;
}

// Of the visible texels of every frame, those that two frames or more see.
Observations shared(const std::vector<std::vector<TexelId>>& visible, std::size_t texels)
{
    std::vector<std::uint32_t> views(texels, 0);
    for (const auto& frame : visible)
        for (const TexelId t : frame)
            ++views[t];
    std::vector<std::uint8_t> is_shared(texels);
    std::ranges::transform(views, is_shared.begin(), [](std::uint32_t n) { return n >= 2; });
    std::vector<TexelId> same(texels);
    std::iota(same.begin(), same.end(), 0u);
    return listed(visible, is_shared, same);
}

} // namespace

Observations observe(const AlignmentScene& scene, const AlignmentState& state, const Texels& texels, int level)
{
    std::vector<std::vector<TexelId>> visible(scene.frames());
    const TexelLanes lanes = texel_lanes(texels);
    parallel_for(visible.size(), [&](std::size_t k) { visible[k] = visible_texels(scene, state, k, level, lanes); });
    return shared(visible, texels.size());
}

void DepthSamples::add(std::uint32_t frame, std::vector<DepthSample> samples)
{
    std::ranges::stable_sort(samples, {}, &DepthSample::plane);
    for (const DepthSample& sample : samples) {
        const auto at = static_cast<std::uint32_t>(size());
        if (run.empty() || run.back().frame != frame || run.back().plane != sample.plane)
            run.push_back({frame, at, at, sample.plane});
        run.back().end = at + 1;
        x.push_back(sample.p_camera.x());
        y.push_back(sample.p_camera.y());
        z.push_back(sample.p_camera.z());
        inverse_sigma.push_back(sample.inverse_sigma);
    }
}

DepthSamples sample_depths(const AlignmentScene& scene, const AlignmentState& state)
{
    std::vector<std::vector<DepthSample>> samples(scene.frames());
    parallel_for(samples.size(), [&](std::size_t k) { samples[k] = sample_frame(scene, state, k); });
    DepthSamples result;
    for (std::uint32_t k = 0; k < samples.size(); ++k)
        result.add(k, std::move(samples[k]));
    return result;
}

Observations in_both(const Observations& a, const Observations& b)
{
    const auto of_frame = [](const Observations& list, std::size_t k) {
        return std::span(list.texel)
            .subspan(list.first_of_frame[k], list.first_of_frame[k + 1] - list.first_of_frame[k]);
    };
    std::vector<std::vector<TexelId>> visible(a.first_of_frame.size() - 1);
    parallel_for(visible.size(), [&](std::size_t k) {
        std::ranges::set_intersection(of_frame(a, k), of_frame(b, k), std::back_inserter(visible[k]));
    });
    return shared(visible, a.first_of_texel.size() - 1);
}

Observations kept(const Observations& observations, const std::vector<std::uint8_t>& keep)
{
    std::vector<std::vector<TexelId>> visible(observations.first_of_frame.size() - 1);
    std::vector<TexelId> number(keep.size());
    TexelId next = 0;
    for (std::size_t t = 0; t < keep.size(); ++t)
        number[t] = keep[t] ? next++ : next;
    for (std::size_t o = 0; o < observations.size(); ++o)
        visible[observations.frame[o]].push_back(observations.texel[o]);
    Observations result = listed(visible, keep, number);
    result.first_of_texel.resize(next + std::size_t{1}, static_cast<std::uint32_t>(result.size()));
    return result;
}

} // namespace quoin
