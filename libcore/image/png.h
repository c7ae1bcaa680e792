// PNG by libpng (which stays in the .cpp).
#pragma once

#include "image/image_io.h"
#include "image/raster.h"

namespace quoin::formats {

ImageInfo png_info(Bytes bytes, const std::string& name); // with an alpha channel when there is transparency

// Grey or RGB, of 8 or 16 bits; alpha is left out. The size is the file's whatever is asked.
Raster decode_png(Bytes bytes, const std::string& name, const Request& request);

} // namespace quoin::formats
