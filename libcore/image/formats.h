// What image_io.cpp and formats.cpp share: marks that begin and end image files.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace quoin::formats {

using Bytes = std::span<const std::byte>;

bool is_jpeg(Bytes bytes);
bool is_png(Bytes bytes);

// Throws InputError, naming `name`, for an empty file and for a JPEG or PNG that lacks its end.
void check_complete(Bytes bytes, const std::string& name);

// Throws InputError "<name>: <found>; expected <expected>".
[[noreturn]] void refuse(const std::string& name, const std::string& found, const std::string& expected);

// The same for a file that a decoder gave up on, with its words.
[[noreturn]] void refuse_undecodable(const std::string& name, const std::string& why);

constexpr const char* kReadFormats = "a JPEG, PNG, BMP, TIFF or WebP file";

} // namespace quoin::formats
