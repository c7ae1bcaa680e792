// JPEG by libjpeg (which stays in the .cpp).
#pragma once

#include "image/image.h"
#include "image/image_io.h"
#include "image/raster.h"

#include <optional>

namespace quoin::formats {

ImageInfo jpeg_info(Bytes bytes, const std::string& name);

// None for one that is neither grey nor YCbCr nor RGB: printers' colours are left to other_formats.h.
std::optional<Raster> decode_jpeg(Bytes bytes, const std::string& name, const Request& request);

} // namespace quoin::formats
