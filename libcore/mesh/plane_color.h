#pragma once

#include "geometry/plane.h"
#include "image/image.h"

namespace quoin {

// A colour to tell planes apart by, the same in every file and picture.
Rgb8 plane_color(PlaneId id);

} // namespace quoin
