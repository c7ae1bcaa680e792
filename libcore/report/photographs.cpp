#include "base/parallel.h"
#include "image/image_io.h"
#include "image/sampling.h"
#include "report/page_data.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace quoin {
namespace {

using Json = nlohmann::ordered_json;

// Positions in the keyframes: of each stretch of the scan, the keyframe with the most lines.
std::vector<std::size_t> choose_keyframes(const ReportParts& parts, std::size_t count)
{
    const auto& frames = parts.keyframes->frame;
    std::vector<std::size_t> lines(parts.scan->frames.size(), 0);
    if (parts.lines)
        for (const LineMatch& line : *parts.lines)
            ++lines[line.frame];
    count = std::min(count, frames.size());
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < count; ++i) {
        const auto begin = frames.begin() + static_cast<std::ptrdiff_t>(i * frames.size() / count);
        const auto end = frames.begin() + static_cast<std::ptrdiff_t>((i + 1) * frames.size() / count);
        const auto best = std::max_element(begin, end, [&](FrameId a, FrameId b) { return lines[a] < lines[b]; });
        chosen.push_back(static_cast<std::size_t>(best - frames.begin()));
    }
    return chosen;
}

ColorImage reduced(ColorImage image, int width)
{
    while (image.width >= 2 * width)
        image = half_size(image);
    return image;
}

} // namespace

void add_photographs(const ReportParts& parts, const ReportLimits& limits, Json& data, PageArrays& arrays)
{
    if (!parts.images || !parts.scan || !parts.keyframes) return;
    const auto chosen = choose_keyframes(parts, limits.photographs);
    std::vector<std::vector<std::byte>> picture(chosen.size());
    parallel_for(chosen.size(), [&](std::size_t i) {
        const ColorImage image = parts.images->color(parts.keyframes->frame[chosen[i]]);
        picture[i] = encode_jpeg(reduced(image, limits.photograph_width), limits.jpeg_quality);
    });
    data["photographs"] = Json::array();
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const FrameId frame = parts.keyframes->frame[chosen[i]];
        Json segments = Json::array();
        if (parts.lines)
            for (const LineMatch& line : *parts.lines)
                if (line.frame == frame)
                    segments.push_back({line.segment[0], line.segment[1], line.segment[2], line.segment[3]});
        arrays.add_image(fmt::format("photograph-{}", i), "image/jpeg", picture[i]);
        data["photographs"].push_back({{"camera", chosen[i]},
                                       {"frame", frame},
                                       {"width", parts.scan->color.width},
                                       {"height", parts.scan->color.height},
                                       {"segments", segments}});
    }
}

} // namespace quoin
