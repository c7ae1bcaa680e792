// How like two images are: of a rendered view and the photograph.
#pragma once

#include "image/image.h"

#include <Eigen/Core>
#include <array>

namespace quoin {

using Mask = Image<std::uint8_t>; // not 0 = counts

// photo ~ gain * render + bias, per channel, by least squares over the mask.
struct AffineColor {
    Eigen::Vector3d gain = Eigen::Vector3d::Ones();
    Eigen::Vector3d bias = Eigen::Vector3d::Zero(); // of 255
};
AffineColor fit_affine_color(const ColorImage& render, const ColorImage& photo, const Mask& mask);
ColorImage apply_color(const AffineColor& fit, const ColorImage& image);

// Peak signal-to-noise ratio over the mask, all channels [dB]; 99 for equal images, NaN for an empty mask.
double psnr(const ColorImage& render, const ColorImage& photo, const Mask& mask);
// Structural similarity of luma, the mean over the mask; 11x11 Gaussian window of sigma 1.5 (Wang et al. 2004). Pixels
// outside the mask count as equal to the photograph. NaN for an empty mask.
double ssim(const ColorImage& render, const ColorImage& photo, const Mask& mask);
// Mean gradient of luma in the render over that in the photograph, where mask and neighbours are set: 1 = as sharp.
double gradient_ratio(const ColorImage& render, const ColorImage& photo, const Mask& mask);

} // namespace quoin
