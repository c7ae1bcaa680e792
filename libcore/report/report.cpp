#include "report/report.h"

#include "base/error.h"
#include "report/page_data.h"
#include "report/page_text.h"

#include <array>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>

namespace quoin {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kDigestMark = "<meta name=\"quoin.report\" content=\"";

void check(const ReportParts& parts)
{
    if (!parts.model() || parts.model()->mesh.face.empty())
        throw ImpossibleError("there is no model with faces to report on; run the pipeline at least until `simplify`");
    const auto refuse = [](const char* what, std::size_t found, std::size_t expected) {
        throw InputError(
            fmt::format("{}: found {}, expected {}; give the artifacts of one pipeline run", what, found, expected));
    };
    if (!parts.face_filled.empty() && parts.face_filled.size() != parts.model()->mesh.face.size())
        refuse("marks of closed holes, one a face", parts.face_filled.size(), parts.model()->mesh.face.size());
    if (!parts.scan || !parts.keyframes) return;
    const std::size_t frames = parts.scan->frames.size(), keyframes = parts.keyframes->frame.size();
    if (parts.keyframes->reason.size() != frames || parts.keyframes->blur.size() != frames)
        refuse("frames judged by select-keyframes", parts.keyframes->reason.size(), frames);
    for (const FrameId id : parts.keyframes->frame)
        if (id >= frames) refuse("number of a keyframe", id, frames);
    if (parts.alignment && parts.alignment->camera_from_world.size() != keyframes)
        refuse("poses of the alignment, one a keyframe", parts.alignment->camera_from_world.size(), keyframes);
    if (parts.lines)
        for (const LineMatch& line : *parts.lines)
            if (line.frame >= frames) refuse("frame of a line", line.frame, frames);
}

// JSON inside a script element: no text of it may look like the element's end.
std::string script_text(const Json& data)
{
    std::string text;
    for (const char c : data.dump(-1, ' ', false, Json::error_handler_t::replace))
        text += c == '<' ? std::string("\\u003c") : std::string(1, c);
    return text;
}

std::string html_text(const std::string& plain)
{
    const std::map<char, std::string> escapes{{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}};
    std::string text;
    for (const char c : plain)
        text += escapes.contains(c) ? escapes.at(c) : std::string(1, c);
    return text;
}

std::string all_scripts()
{
    std::string text;
    for (const char* name : {"matrices.js", "orbit.js", "viewer.js", "measure.js", "charts.js", "page.js"})
        text += page_text(name);
    return text;
}

// The template with every {{name}} replaced, once each.
std::string fill_template(std::string_view page, const std::map<std::string_view, std::string>& values)
{
    std::string text;
    while (true) {
        const auto begin = page.find("{{"), end = page.find("}}", begin);
        text += page.substr(0, begin);
        if (begin == std::string_view::npos) return text;
        text += values.at(page.substr(begin + 2, end - begin - 2));
        page.remove_prefix(end + 2);
    }
}

} // namespace

std::string make_report(const ReportParts& parts, const ReportLimits& limits)
{
    check(parts);
    Json data;
    PageArrays arrays;
    add_figures(parts, data);
    add_scene(parts, limits, data, arrays);
    add_photographs(parts, limits, data, arrays);
    return fill_template(page_text("report.html"), {{"digest", html_text(parts.digest)},
                                                    {"title", html_text(parts.scan_name)},
                                                    {"style", std::string(page_text("report.css"))},
                                                    {"data", script_text(data)},
                                                    {"arrays", arrays.take()},
                                                    {"script", all_scripts()}});
}

std::string report_digest(const std::string& page)
{
    const auto mark = page.find(kDigestMark);
    if (mark == std::string::npos) return {};
    const auto begin = mark + kDigestMark.size();
    return page.substr(begin, page.find('"', begin) - begin);
}

} // namespace quoin
