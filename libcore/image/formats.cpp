#include "image/formats.h"

#include "base/error.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>

namespace quoin::formats {
namespace {

template <std::size_t N>
bool starts_with(Bytes bytes, const std::array<std::uint8_t, N>& magic)
{
    return bytes.size() >= N && std::memcmp(bytes.data(), magic.data(), N) == 0;
}

template <std::size_t N>
Bytes::iterator find_last(Bytes bytes, const std::array<std::uint8_t, N>& mark)
{
    return std::ranges::find_end(bytes, std::as_bytes(std::span(mark))).begin();
}

constexpr std::array<std::uint8_t, 3> kJpegMagic{0xff, 0xd8, 0xff};
constexpr std::array<std::uint8_t, 8> kPngMagic{0x89, 'P', 'N', 'G', 0x0d, 0x0a, 0x1a, 0x0a};

// A decoder fills what is missing with grey and only mumbles, so the end of the file is looked for here: the last scan
// of a JPEG is followed by an end mark (a mark inside the compressed data would be escaped), a PNG ends with IEND.
bool is_complete(Bytes bytes)
{
    constexpr std::array<std::uint8_t, 2> scan_mark{0xff, 0xda}, end_mark{0xff, 0xd9};
    constexpr std::array<std::uint8_t, 4> end_chunk{'I', 'E', 'N', 'D'};
    if (is_jpeg(bytes)) {
        const auto end = find_last(bytes, end_mark);
        return end != bytes.end() &&
               find_last(bytes.first(static_cast<std::size_t>(end - bytes.begin())), scan_mark) != end;
    }
    if (is_png(bytes)) return find_last(bytes, end_chunk) != bytes.end();
    return true;
}

} // namespace

bool is_jpeg(Bytes bytes) { return starts_with(bytes, kJpegMagic); }
bool is_png(Bytes bytes) { return starts_with(bytes, kPngMagic); }

void check_complete(Bytes bytes, const std::string& name)
{
    if (bytes.empty()) throw InputError(name + ": the file is empty; expected an image; copy it again");
    if (!is_complete(bytes))
        throw InputError(
            fmt::format("{}: the image is cut off after {} bytes; copy the file again", name, bytes.size()));
}

void refuse(const std::string& name, const std::string& found, const std::string& expected)
{
    throw InputError(fmt::format("{}: {}; expected {}", name, found, expected));
}

void refuse_undecodable(const std::string& name, const std::string& why)
{
    refuse(name, fmt::format("cannot decode the image ({})", why), kReadFormats);
}

} // namespace quoin::formats
