#pragma once

#include <cstddef>
#include <cstdint>

#include "master/filter/svgf/edge_stops.h"
#include "master/filter/svgf/guides.h"
#include "master/filter/svgf/padded_planes.h"

// Weights of rows of pairs, of which each wavelet has other taps. Inlined by force: as functions of several files they
// are a third slower.
namespace tessera::filter::svgf {

// One end of a row of pairs.
struct PairEnd {
    const float *nx, *ny, *nz, *inverse_depth, *depth_scale, *luminance, *luminance_scale;
    const std::uint32_t* ids;
};

// From column x of row y on. The scales and luminances are those of the row, from its column 0.
[[gnu::always_inline]] inline PairEnd pair_end(const Guides& guides, const float* depth_scale,
                                               const float* luminance, const float* luminance_scale,
                                               std::uint32_t y, std::int64_t x) {
    return {guides.normal.row(0, y) + x,
            guides.normal.row(1, y) + x,
            guides.normal.row(2, y) + x,
            guides.inverse_depth.row(0, y) + x,
            depth_scale + x,
            luminance + x,
            luminance_scale + x,
            guides.ids.data() + std::int64_t{y} * guides.inverse_depth.width() + x};
}

// E-D8 of `count` pairs: 0 between objects and between surfaces that face each other's back.
[[gnu::always_inline]] inline void pair_weights(const PairEnd& a, const PairEnd& b, std::size_t count,
                                                float kernel, float sigma_n, float* __restrict weights) {
    for (std::size_t x = 0; x < count; ++x) {
        const float dot = a.nx[x] * b.nx[x] + a.ny[x] * b.ny[x] + a.nz[x] * b.nz[x];
        const float depth =
            std::fabs(a.inverse_depth[x] - b.inverse_depth[x]) * std::max(a.depth_scale[x], b.depth_scale[x]);
        const float light =
            std::fabs(a.luminance[x] - b.luminance[x]) * std::max(a.luminance_scale[x], b.luminance_scale[x]);
        const float w = kernel * exp_negative(-(normal_distance(dot, sigma_n) + depth + light));
        weights[x] = (a.ids[x] == b.ids[x]) & (dot > 0.0f) ? w : 0.0f;
    }
}

// Luminance of a row, and its scale.
[[gnu::always_inline]] inline void luminance_terms(const PaddedPlanes& from, std::uint32_t y,
                                                   const EdgeStops& stops, float* __restrict luminance,
                                                   float* __restrict scale) {
    const EdgeStops s = stops;
    const float *r = from.row(0, y), *g = from.row(1, y), *b = from.row(2, y), *v = from.row(3, y);
    const bool square_root = s.deviation != Deviation::Variance;
    for (std::size_t x = 0; x < from.width(); ++x) {
        const float l = luma(r[x], g[x], b[x]);
        luminance[x] = l;
        scale[x] = luminance_scale(l, square_root ? std::sqrt(v[x]) : v[x], s);
    }
}

}  // namespace tessera::filter::svgf
