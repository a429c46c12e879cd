#pragma once

#include "master/filter/pixel/light.h"

namespace tessera::filter::pixel {

enum class Root { Simple, Covariance };

struct Blend {
    float threshold = 0.01f;  // t
    Root root = Root::Simple;
    float spike_clamp = 2.0f;  // c; 0: none
};

// Maps of one component; empty ones are not written.
struct BlendMaps {
    Planes* smoothed_variance = nullptr;  // of the luminance of the mean
    Planes* blend = nullptr;              // s
    Planes* self_weight = nullptr;        // of a pixel's own light in the picture: s + (1 - s) a
};

// L_lv + s L_u' + (1 - s) L_f (Schwenk 3.1), s per pixel from the perceived variances. The variance in
// `filtered` is that of one sample; it and r are those of the last filter pass, and the number of samples is
// the current one. s = 1 gives the bits of the unfiltered picture; s = 0 where n < 2. Alpha is blended with
// the same s. False: stopped.
bool compose(const Inputs& inputs, const Light& light, const Field& filtered, const Blend& blend,
             Planes& picture, const BlendMaps& maps, RunContext& context);

}  // namespace tessera::filter::pixel
