#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Pixel filtering (Schwenk ch. 3): the light of the view's path class goes through a wide cross-bilateral
// filter guided by the headlight feature (the thesis' range buffer), and is blended with the unfiltered one
// so that the perceived variance of the result just meets a threshold. Where the unfiltered light already
// meets the threshold (s = 1) the picture is the unfiltered one, bit for bit: the filter is consistent.
//
// One run: the guide; widths per pixel from a coarse estimate (Schwenk 3.6.3); the filter over light,
// variance and alpha with the same weights, which reports r (3.5, 3.6); the blend (3.1 to 3.13) with the
// spike clamp (3.18).
//
// With schedule=on an instance filters only when the median of the counts has reached the next of 4, 8, 16,
// ... since its last pass, or when a parameter, the film or the scene has changed; other runs blend the
// current samples with the light of the last pass, whose variance shrinks with n. Before 4 samples the
// picture is unfiltered. reset() discards the last pass.
//
// Without HighVariance all radiance is filtered, without Headlight only depth guides; the report notes both.
FilterEntry pixel_entry();

}  // namespace tessera::filter
