#pragma once

#include "image/image.h"

namespace quoin {

// The no-reference blur metric of Crete et al. (2007): how little a 9-tap box filter takes from the differences between
// neighbouring pixels. 0 is sharp, 1 is blurred; an image without any difference is 1.
double blur_of(const GrayImage& gray);

} // namespace quoin
