#include "keyframes/select_keyframes.h"

#include "base/error.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "keyframes/blur.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <span>

namespace quoin {
namespace {

// Why a frame cannot be a keyframe whatever its sharpness; Kept = it can.
Dropped unusable(const Frame& frame, const KeyframeParams& params)
{
    if (frame.use == FrameUse::Invalid) return Dropped::InvalidPose;
    if (frame.use == FrameUse::HeldOut) return Dropped::HeldOut;
    const bool has_images = frame.has_color() && (frame.has_depth() || !params.require_depth);
    return has_images ? Dropped::Kept : Dropped::NoImage;
}

std::vector<Dropped> unusable_frames(const Scan& scan, const KeyframeParams& params)
{
    std::vector<Dropped> reason;
    for (const Frame& frame : scan.frames)
        reason.push_back(unusable(frame, params));
    return reason;
}

float median(std::vector<float> values)
{
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

// Median + max_blur_deviation * MAD of the usable frames; infinite when there is no spread to compare with.
float blur_limit(const std::vector<float>& blur, const std::vector<Dropped>& reason, const KeyframeParams& params)
{
    constexpr float none = std::numeric_limits<float>::infinity();
    std::vector<float> values;
    for (std::size_t i = 0; i < blur.size(); ++i)
        if (reason[i] == Dropped::Kept) values.push_back(blur[i]);
    if (values.empty() || params.max_blur_deviation == 0.0) return none;
    const float center = median(values);
    for (float& value : values)
        value = std::abs(value - center);
    const float spread = median(std::move(values));
    return spread > 0.0f ? center + static_cast<float>(params.max_blur_deviation) * spread : none;
}

void drop_blurred(const std::vector<float>& blur, const KeyframeParams& params, std::vector<Dropped>& reason)
{
    const float limit = blur_limit(blur, reason, params);
    for (std::size_t i = 0; i < blur.size(); ++i)
        if (reason[i] == Dropped::Kept && blur[i] > limit) reason[i] = Dropped::Blurred;
}

// Keeps the sharpest of the frames; the first one among equals.
void keep_sharpest(std::span<const FrameId> frames, const std::vector<float>& blur, Dropped why,
                   std::vector<Dropped>& reason)
{
    if (frames.empty()) return;
    FrameId best = frames.front();
    for (const FrameId id : frames)
        if (blur[id] < blur[best]) best = id;
    for (const FrameId id : frames)
        if (id != best) reason[id] = why;
}

std::vector<FrameId> kept(const std::vector<Dropped>& reason)
{
    std::vector<FrameId> frames;
    for (FrameId id = 0; id < reason.size(); ++id)
        if (reason[id] == Dropped::Kept) frames.push_back(id);
    return frames;
}

void keep_one_an_interval(const std::vector<float>& blur, const KeyframeParams& params, std::vector<Dropped>& reason)
{
    const std::vector<FrameId> frames = kept(reason);
    const auto interval = static_cast<FrameId>(params.interval);
    for (std::size_t begin = 0; begin < frames.size();) {
        std::size_t end = begin;
        while (end < frames.size() && frames[end] / interval == frames[begin] / interval)
            ++end;
        keep_sharpest({frames.data() + begin, frames.data() + end}, blur, Dropped::NotSharpest, reason);
        begin = end;
    }
}

// Near the one kept before in position AND direction: a pure turn or a pure step shows something new.
void drop_near_duplicates(const Scan& scan, const KeyframeParams& params, std::vector<Dropped>& reason)
{
    const double min_angle = params.min_angle * std::numbers::pi / 180.0;
    const Frame* last = nullptr;
    for (const FrameId id : kept(reason)) {
        const Frame& frame = scan.frames[id];
        const Rigid motion = last ? frame.camera_from_world * last->camera_from_world.inverse() : Rigid::Identity();
        const bool close =
            last && motion.translation().norm() < params.min_translation && rotation_angle(motion.linear()) < min_angle;
        if (close)
            reason[id] = Dropped::TooClose;
        else
            last = &frame;
    }
}

// Cuts the keyframes into max_keyframes groups of neighbours and keeps the sharpest of each.
void limit_number(const std::vector<float>& blur, const KeyframeParams& params, std::vector<Dropped>& reason)
{
    const std::vector<FrameId> frames = kept(reason);
    const auto groups = static_cast<std::size_t>(params.max_keyframes);
    if (groups == 0 || frames.size() <= groups) return;
    const auto cut = [&](std::size_t group) { return frames.data() + group * frames.size() / groups; };
    for (std::size_t group = 0; group < groups; ++group)
        keep_sharpest({cut(group), cut(group + 1)}, blur, Dropped::OverLimit, reason);
}

} // namespace

std::vector<float> measure_blur(const ScanImages& images, const KeyframeParams& params)
{
    const std::vector<Frame>& frames = images.scan().frames;
    const int reduction = 1 << static_cast<int>(params.blur_scale);
    std::vector<float> blur(frames.size(), std::numeric_limits<float>::quiet_NaN());
    Progress progress("measuring blur", frames.size());
    parallel_for(frames.size(), [&](std::size_t i) {
        if (unusable(frames[i], params) == Dropped::Kept)
            blur[i] = static_cast<float>(blur_of(images.recorded_gray(static_cast<FrameId>(i), reduction)));
        progress.step();
    });
    return blur;
}

Keyframes choose_keyframes(const Scan& scan, std::vector<float> blur, const KeyframeParams& params)
{
    std::vector<Dropped> reason = unusable_frames(scan, params);
    drop_blurred(blur, params, reason);
    keep_one_an_interval(blur, params, reason);
    drop_near_duplicates(scan, params, reason);
    limit_number(blur, params, reason);
    const std::vector<FrameId> frames = kept(reason);
    if (frames.empty())
        throw ImpossibleError(fmt::format(
            "none of the {} frames can be a keyframe: each lacks a valid pose or {}; check the scan with import",
            scan.frames.size(), params.require_depth ? "an image (or set require_depth=false)" : "an image"));
    return {frames, std::move(blur), std::move(reason)};
}

Keyframes select_keyframes(const ScanImages& images, const KeyframeParams& params)
{
    return choose_keyframes(images.scan(), measure_blur(images, params), params);
}

} // namespace quoin
