// The sharpest usable frame of every interval (Wang and Guo 2019, section 5), without near duplicates and blurred ones.
#pragma once

#include "base/param.h"
#include "scan/keyframes.h"

#include <array>

namespace quoin {

enum class BlurScale { Full, Half, Quarter };
constexpr auto choice_names(BlurScale) { return std::array{"full", "half", "quarter"}; }

struct KeyframeParams {
    int interval = 5;
    BlurScale blur_scale = BlurScale::Full;
    double max_blur_deviation = 3.0;
    double min_translation = 0.03;
    double min_angle = 2.0;
    int max_keyframes = 600;
    bool require_depth = false;

    static constexpr auto list()
    {
        using P = KeyframeParams;
        return std::tuple{
            Param{"interval", &P::interval, "", "frames of which the sharpest is taken", 1.0, 1e6},
            Param{"blur_scale", &P::blur_scale, "", "size of the images that the blur is measured on"},
            Param{"max_blur_deviation", &P::max_blur_deviation, "",
                  "a frame is too blurred above median + so many median absolute deviations; 0 = never", 0.0, 1e6},
            Param{"min_translation", &P::min_translation, "m",
                  "a keyframe nearer than this and min_angle to the one before is dropped; 0 = none is", 0.0, 1e3},
            Param{"min_angle", &P::min_angle, "deg",
                  "a keyframe turned by less than this and nearer than min_translation is dropped; 0 = none is", 0.0,
                  180.0},
            Param{"max_keyframes", &P::max_keyframes, "", "largest number of keyframes; 0 = any", 0.0, 1e6},
            Param{"require_depth", &P::require_depth, "", "a keyframe must have a depth image"},
        };
    }
};

// Blur of every frame that may become a keyframe, NaN of the others; reads images in parallel.
std::vector<float> measure_blur(const ScanImages& images, const KeyframeParams& params);

// Chooses by poses and blur alone. Every frame that is not chosen gets a reason. Throws ImpossibleError when no frame
// is usable.
Keyframes choose_keyframes(const Scan& scan, std::vector<float> blur, const KeyframeParams& params);

// Both of these.
Keyframes select_keyframes(const ScanImages& images, const KeyframeParams& params);

} // namespace quoin
