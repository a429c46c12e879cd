#pragma once

#include "mediator/frame/image.h"

// FLIP, the perceived difference when alternating between two pictures, at 67.02 pixels per degree (0.7 m
// from a display 0.7 m wide with 3840 pixels). 0 = none, 1 = largest; the mean over pixels is returned. One
// or three components, linear Rec. 709; throws Error{InvalidInput} for others and for pictures of different
// size. Negative values and NaN count as black.
namespace tessera::picture {

// For pictures made for a display: values above 1 are white.
// Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", PACMCGIT 3(2), 2020.
double ldr_flip_mean(const frame::Image& picture, const frame::Image& reference);

// For high dynamic range: per pixel the largest difference over a range of exposures given by the reference.
// Andersson et al., "Visualizing Errors in Rendered High Dynamic Range Images", Eurographics 2021.
double hdr_flip_mean(const frame::Image& picture, const frame::Image& reference);

}  // namespace tessera::picture
