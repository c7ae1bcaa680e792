// BMP, TIFF, WebP and whatever else OpenCV and OpenImageIO read. They and all that comes with them take 0.4 s to load,
// so they are a library of its own (other/), loaded when such a file is met.
#pragma once

#include "image/image_io.h"
#include "image/raster.h"

namespace quoin::formats {

ImageInfo inspect_other(Bytes bytes, const std::string& name);

// Alpha is left out. The size is the file's whatever is asked.
Raster decode_other(Bytes bytes, const std::string& name, const Request& request);

} // namespace quoin::formats
