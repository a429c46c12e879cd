#include "master/filter/pixel/light.h"

#include <algorithm>

namespace tessera::filter::pixel {

namespace {

using frame::Channel;

constexpr float Most = 1e30f;

float tone_compress(float value) {
    return std::min(std::max(value, -Most), Most);
}

// value(i) for the pixels of row y; holes take that of their origin. The second loop is rarely needed;
// separate, so that the first one vectorises.
template <class Value>
void fill_row(const Inputs& inputs, const Holes& holes, std::uint32_t y, float* to, const Value& value) {
    const std::size_t first = std::size_t{y} * inputs.width;
    for (std::size_t x = 0; x < inputs.width; ++x) to[x] = value(first + x);
    if (!holes.any()) return;
    for (std::size_t x = 0; x < inputs.width; ++x) to[x] = value(holes.origin(first + x));
}

}  // namespace

void Light::prepare(const Inputs& inputs, const Holes& holes, RunContext& context) {
    const bool split = inputs.has(Channel::HighVariance);
    const bool low_is_there = split && inputs.has(Channel::LowVariance);
    const Planes& radiance = inputs.mean(Channel::Radiance);
    const Planes& high = split ? inputs.mean(Channel::HighVariance) : radiance;
    const Planes& low = low_is_there ? inputs.mean(Channel::LowVariance) : radiance;
    high_ = holes.any() ? &own_high_ : &high;
    low_ = holes.any() || !low_is_there ? &own_low_ : &low;
    if (high_ == &own_high_) shape(own_high_, inputs, 3);
    if (low_ == &own_low_) shape(own_low_, inputs, 3);
    for_rows(context, inputs.height, [&](std::uint32_t y) {
        for (std::uint32_t c = 0; c < 3; ++c) {
            const float *h = high.plane(c).data(), *l = low.plane(c).data();
            if (high_ == &own_high_) {
                fill_row(inputs, holes, y, own_high_.row(c, y), [h](std::size_t i) { return h[i]; });
            }
            if (low_ != &own_low_) continue;
            float* to = own_low_.row(c, y);
            if (low_is_there)
                fill_row(inputs, holes, y, to, [l](std::size_t i) { return l[i]; });
            else
                fill_row(inputs, holes, y, to, [h, l](std::size_t i) { return l[i] - h[i]; });
        }
    });
}

void Light::fill(const Inputs& inputs, const Holes& holes, Field& field, RunContext& context) const {
    const bool alpha = inputs.has(Channel::Alpha);
    field.fit(inputs.width, inputs.height, alpha ? 5 : 4);
    const Channel channel = inputs.has(Channel::HighVariance) ? Channel::HighVariance : Channel::Radiance;
    const Planes &mean = inputs.mean(channel), &variance = inputs.variance(channel);
    const float* n = inputs.counts.plane(0).data();
    const float *r = mean.plane(0).data(), *g = mean.plane(1).data(), *b = mean.plane(2).data();
    const float *vr = variance.plane(0).data(), *vg = variance.plane(1).data(),
                *vb = variance.plane(2).data();
    for_rows(context, inputs.height, [&](std::uint32_t y) {
        for (std::uint32_t c = 0; c < 3; ++c) {
            const float* from = high().row(c, y);
            float* to = field.values.row(c, y);
            for (std::uint32_t x = 0; x < inputs.width; ++x) to[x] = tone_compress(from[x]);
        }
        fill_row(inputs, holes, y, field.values.row(Field::Variance, y), [&](std::size_t i) {
            const float single = tone_compress(luminance(r[i], g[i], b[i]));
            const float known = luminance_variance(vr[i], vg[i], vb[i]);
            return std::min(n[i] < 2.0f ? single * single : known, Most);
        });
        if (alpha) {
            const float* from = inputs.mean(Channel::Alpha).plane(0).data();
            fill_row(inputs, holes, y, field.values.row(Field::Alpha, y),
                     [from](std::size_t i) { return from[i]; });
        }
        std::fill_n(field.reduction.row(0, y), inputs.width, 1.0f);
    });
}

}  // namespace tessera::filter::pixel
