#pragma once

#include "master/filter/pixel/gather.h"

namespace tessera::filter::pixel {

// A pixel crossed by an antialiased edge has no similar neighbours. In the direction of a sweep it is
// modelled as a mixture of the two regions next to it (Schwenk 3.6.5): their colours P0 and P2 are the two
// sides of a Sobel operator, and `coverage` is the position of the pixel's own colour on the line from P0 to
// P2. `belief` is the range weight of its distance to that line; it falls to 0 where P0 and P2 are less than
// 2 sigma_c apart, since the two-sided filter accepts both then. The thesis does not define depth and normal
// of P0 and P2: here they are those of the next pixel on that side.
template <std::size_t Features>
struct EdgeModel {
    std::array<Pack, Features> low, high;
    Pack coverage, belief;
};

// `before`, `after`: floats to the neighbours across the direction.
template <std::size_t Features>
inline EdgeModel<Features> edge_model(const std::array<const float*, Features>& sources,
                                      const std::array<Pack, Features>& target, std::ptrdiff_t stride,
                                      std::ptrdiff_t before, std::ptrdiff_t after) {
    EdgeModel<Features> model;
    const auto side = [&](const float* row) {
        return 0.25f * (load(row + before) + load(row + after)) + 0.5f * load(row);
    };
    Pack squared{}, along{};
    for (std::size_t k = 0; k < 3; ++k) {
        model.low[k] = side(sources[k] - stride);
        model.high[k] = side(sources[k] + stride);
        const Pack line = model.high[k] - model.low[k];
        squared += line * line;
        along += line * (target[k] - model.low[k]);
    }
    for (std::size_t k = 3; k < Features; ++k) {
        model.low[k] = load(sources[k] - stride);
        model.high[k] = load(sources[k] + stride);
    }
    model.coverage = min(max(along / max(squared, all(1e-30f)), Pack{}), all(1.0f));
    Pack off{};
    for (std::size_t k = 0; k < 3; ++k) {
        const Pack line = model.high[k] - model.low[k];
        const Pack offset = target[k] - model.low[k] - model.coverage * line;
        off += offset * offset;
    }
    // Squared distances are in units of 2 sigma_c^2 / log2(e): from 2 to 3 sigma_c the belief grows from 0 to
    // 1.
    constexpr float Two = 4.0f * 0.5f * 1.44269504f, Three = 9.0f * 0.5f * 1.44269504f;
    const Pack distinct = min(max((squared - Two) / (Three - Two), Pack{}), all(1.0f));
    // Outside the picture and in holes there is no region.
    const Pack deepest = max(model.low[Guide::Depth], model.high[Guide::Depth]);
    model.belief = deepest < Guide::Nowhere ? distinct * exp2_negative(off) : Pack{};
    return model;
}

}  // namespace tessera::filter::pixel
