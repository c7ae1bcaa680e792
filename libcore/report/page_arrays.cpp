#include "report/page_arrays.h"

#include <fmt/format.h>

namespace quoin {

std::string base64(std::span<const std::byte> bytes)
{
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t triple = 0;
        for (std::size_t k = 0; k < 3; ++k)
            triple = triple << 8 | (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k <= bytes.size() ? kDigits[triple >> (18 - 6 * k) & 63u] : '=';
    }
    return text;
}

void PageArrays::add_element(const std::string& id, std::string_view mime, std::string_view element,
                             std::span<const std::byte> bytes)
{
    html_ += fmt::format("<script type=\"{}\" id=\"{}\"", mime, id);
    if (!element.empty()) html_ += fmt::format(" data-type=\"{}\"", element);
    html_ += ">" + base64(bytes) + "</script>\n";
}

} // namespace quoin
