#pragma once

#include "image/image.h"

namespace quoin {

// Lowers every pixel to the least of: its own value, and another pixel's value plus the distance to it [px], by two
// chamfer sweeps. `outside` is the value of pixels beside the image.
Image<float> grow_distances(Image<float> distance, float outside);

} // namespace quoin
