#pragma once

#include "mediator/frame/image.h"

// Error metrics of a picture against a reference. Every function takes linear values of equal size and number of
// components, and throws Error{InvalidInput} otherwise. Equal values, including infinities, differ by 0; NaN
// propagates.
namespace tessera::picture {

// Mean over pixels and components of (x - r)^2.
double mse(const frame::Image& picture, const frame::Image& reference);

// Mean over pixels and components of (x - r)^2 / (r^2 + e), e = 0.01 (mean luminance of the reference)^2.
// Nothing is clipped. Unless there are three components, their mean is the luminance.
double relmse(const frame::Image& picture, const frame::Image& reference);

// The two below compare tone-mapped pictures: both times 0.18 / (logarithmic mean luminance of
// the reference), then c / (1 + c) per component, then sRGB; in [0, 1]. Negative values and NaN count as black.

// 10 log10(1 / mean squared difference) in decibels; +inf for equal pictures.
double psnr(const frame::Image& picture, const frame::Image& reference);

// Mean structural similarity of the luminance (Wang et al. 2004: Gaussian window of 11 x 11 pixels,
// sigma 1.5, K1 = 0.01, K2 = 0.03); 1 for equal pictures.
double ssim(const frame::Image& picture, const frame::Image& reference);

}  // namespace tessera::picture
