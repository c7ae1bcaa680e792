// What other_formats.cpp finds in the library that it loads. Both are built together, so that C++ types may pass.
#pragma once

#include "image/image_io.h"
#include "image/raster.h"

namespace quoin::formats {

constexpr const char* kLibraryName = "libquoin-image-formats.so";
constexpr const char* kInspectName = "quoin_inspect_image";
constexpr const char* kDecodeName = "quoin_decode_image";

// Each returns what is wrong with the file, or "".
using InspectFunction = std::string(Bytes bytes, const std::string& name, ImageInfo& info);
using DecodeFunction = std::string(Bytes bytes, const Request& request, Raster& raster);

} // namespace quoin::formats
