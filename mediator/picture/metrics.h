#pragma once

#include "mediator/frame/image.h"

// How far a picture is from a reference. Every function takes linear values of equal size and number of
// components, and throws Error{InvalidInput} otherwise. Equal values, infinite ones too, differ by 0; NaN
// stays.
namespace tessera::picture {

// Mean over pixels and components of (x - r)^2.
double mse(const frame::Image& picture, const frame::Image& reference);

// Mean over pixels and components of (x - r)^2 / (r^2 + e), e = 0.01 (mean luminance of the reference)^2.
// Nothing is clipped. Two components or other than colours: the mean of the finite values is the luminance.
double relmse(const frame::Image& picture, const frame::Image& reference);

// The two below look at pictures as a display shows them: both times 0.18 / (logarithmic mean luminance of
// the reference), then c / (1 + c) per component, then sRGB; in [0, 1]. What is negative or NaN is black.

// 10 log10(1 / mean squared difference) in decibels; +inf for equal pictures.
double psnr(const frame::Image& picture, const frame::Image& reference);

// Mean structural similarity of the luminance (Wang et al. 2004: Gaussian window of 11 x 11 pixels,
// sigma 1.5, K1 = 0.01, K2 = 0.03); 1 for equal pictures.
double ssim(const frame::Image& picture, const frame::Image& reference);

}  // namespace tessera::picture
