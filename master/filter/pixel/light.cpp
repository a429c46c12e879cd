#include "master/filter/pixel/light.h"

#include <algorithm>
#include <limits>

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

void Light::prepare(const Inputs& inputs, const Holes& holes, LightScope which, RunContext& context) {
    least_count_ = std::numeric_limits<float>::max();
    largest_count_ = 0.0f;
    for (const float n : inputs.counts.plane(0)) {
        least_count_ = n > 0.0f ? std::min(least_count_, n) : least_count_;
        largest_count_ = std::max(largest_count_, n);
    }
    const bool split = which == LightScope::PathClass && inputs.has(Channel::HighVariance);
    channel_ = split ? Channel::HighVariance : Channel::Radiance;
    const bool low_is_there = split && inputs.has(Channel::LowVariance);
    const Planes& radiance = inputs.mean(Channel::Radiance);
    const Planes& high = inputs.mean(channel_);
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
    const bool alpha = inputs.has(Channel::Alpha), weighted = has_uneven_counts();
    field.fit(inputs.width, inputs.height, 4u + (alpha ? 1u : 0u) + (weighted ? 1u : 0u), weighted);
    const Planes &mean = inputs.mean(channel_), &variance = inputs.variance(channel_);
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
        if (weighted) weigh(inputs, holes, y, field);
    });
}

void Light::weigh(const Inputs& inputs, const Holes& holes, std::uint32_t y, Field& field) const {
    const std::uint32_t last = field.values.components() - 1;
    float *weight = field.values.row(last, y), *variance = field.values.row(Field::Variance, y);
    const float* n = inputs.counts.plane(0).data();
    fill_row(inputs, holes, y, weight, [n](std::size_t i) { return n[i]; });
    for (std::uint32_t x = 0; x < inputs.width; ++x) variance[x] = std::min(variance[x] * weight[x], Most);
    for (std::uint32_t x = 0; x < inputs.width; ++x) weight[x] /= largest_count_;
    for (std::uint32_t c = 0; c < last; ++c) {
        float* values = field.values.row(c, y);
        for (std::uint32_t x = 0; x < inputs.width; ++x) values[x] *= weight[x];
    }
    std::copy_n(weight, inputs.width, field.reduction.row(0, y));
}

void Light::divide_by_counts(const Inputs& inputs, const Holes& holes, Field& field,
                             RunContext& context) const {
    if (!field.weighted) return;
    const float* n = inputs.counts.plane(0).data();
    for_rows(context, inputs.height, [&](std::uint32_t y) {
        const std::uint32_t last = field.values.components() - 1;
        const float* weight = field.weight_row(y);
        for (std::uint32_t c = 0; c < last; ++c) {
            float* values = field.values.row(c, y);
            for (std::uint32_t x = 0; x < inputs.width; ++x) values[x] /= weight[x];
        }
        float* reduction = field.reduction.row(0, y);
        const std::size_t first = std::size_t{y} * inputs.width;
        for (std::uint32_t x = 0; x < inputs.width; ++x) {
            const float own = n[holes.origin(first + x)] / largest_count_;
            reduction[x] = std::min(reduction[x] * own / (weight[x] * weight[x]), 1.0f);
        }
    });
}

}  // namespace tessera::filter::pixel
