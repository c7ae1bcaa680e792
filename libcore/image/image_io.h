// Image files and encoded images (the libraries stay in the .cpp files). Errors: InputError naming the file when it
// is missing, truncated, not an image or of another kind than asked for; ResourceError when it cannot be written.
#pragma once

#include "image/image.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace quoin {

// What the header of an image file says.
struct ImageInfo {
    int width = 0;    // [px]
    int height = 0;   // [px]
    int channels = 0; // 1 grey, 3 RGB, 4 RGBA
    int bits = 0;     // a channel
};

// Reads the header only, and checks that a JPEG or PNG is there to its end; decodes no pixel.
ImageInfo inspect_image(std::span<const std::byte> bytes, const std::string& name);

// A file's whole content.
std::vector<std::byte> read_bytes(const std::filesystem::path& path);

ColorImage read_color(const std::filesystem::path& path);
Image<std::uint16_t> read_gray16(const std::filesystem::path& path); // 8-bit files are refused
// The same from a file's bytes; `name` is what messages call it.
ColorImage decode_color(std::span<const std::byte> bytes, const std::string& name);
GrayImage decode_gray(std::span<const std::byte> bytes, const std::string& name,
                      int reduction = 1); // 1, 2 or 4: at 1/reduction of the size
Image<std::uint16_t> decode_gray16(std::span<const std::byte> bytes, const std::string& name);

std::vector<std::byte> encode_jpeg(const ColorImage& image, int quality); // 4:4:4
std::vector<std::byte> encode_png(const ColorImage& image);
std::vector<std::byte> encode_png(const Image<std::uint8_t>& image);
std::vector<std::byte> encode_png(const Image<std::uint16_t>& image);
void write_png(const std::filesystem::path& path, const ColorImage& image);

} // namespace quoin
