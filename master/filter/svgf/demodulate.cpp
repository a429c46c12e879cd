#include "master/filter/svgf/demodulate.h"

#include "master/filter/svgf/edge_stops.h"

namespace tessera::filter::svgf {

namespace {

using frame::Channel;

constexpr float MostVariance = 1e36f;  // so that sums over a window stay finite

// Standard deviation of the luminance if all components vary together, as light does: an upper bound.
float luma_deviation(float r, float g, float b) {
    return luma(std::sqrt(r), std::sqrt(g), std::sqrt(b));
}

}  // namespace

bool knows_diffuse(const Inputs& inputs) {
    return inputs.path_class == view::PathClass::Diffuse && inputs.has(Channel::HighVariance) &&
           inputs.has(Channel::LowVariance);
}

bool demodulate(const Inputs& inputs, State& state, RunContext& context) {
    const bool divide = knows_diffuse(inputs);
    const Planes& irradiance = inputs.mean(Channel::Irradiance);
    const Planes& variance = inputs.variance(Channel::Irradiance);
    const Planes& albedo = inputs.mean(Channel::Albedo);
    const Planes& diffuse = divide ? inputs.mean(Channel::HighVariance) : irradiance;
    return for_rows(context, inputs.height, [&](std::uint32_t y) {
        const std::size_t width = inputs.width;
        for (std::uint32_t c = 0; c < 3; ++c) {
            const float *light = diffuse.row(c, y), *mean = irradiance.row(c, y), *a = albedo.row(c, y);
            float* __restrict out = state.color.row(c, y);
            for (std::size_t x = 0; x < width; ++x) {
                const float ratio = light[x] / std::max(a[x], LeastAlbedo);
                out[x] = divide & (a[x] > LeastAlbedo) ? ratio : mean[x];
            }
        }
        const float *er = irradiance.row(0, y), *eg = irradiance.row(1, y), *eb = irradiance.row(2, y);
        const float *vr = variance.row(0, y), *vg = variance.row(1, y), *vb = variance.row(2, y);
        const float *red = state.color.row(0, y), *green = state.color.row(1, y),
                    *blue = state.color.row(2, y);
        const float* counts = inputs.counts.row(0, y);
        float* __restrict l = state.moments.row(MeanLuminance, y);
        float* __restrict v = state.moments.row(SampleVariance, y);
        float* __restrict age = state.moments.row(Age, y);
        std::fill_n(state.color.row(OwnWeightComponent, y), width, 1.0f);
#pragma GCC ivdep  // the state is no part of the film
        for (std::size_t x = 0; x < width; ++x) {
            const float n = counts[x];
            const float plain = luma(er[x], eg[x], eb[x]);
            l[x] = luma(red[x], green[x], blue[x]);
            // The surface covers at least 1 / n of the pixel.
            const float scale = std::min(l[x] / std::max(plain, Tiny), std::max(n, 1.0f));
            const float deviation = scale * luma_deviation(vr[x], vg[x], vb[x]);
            v[x] = std::min(deviation * deviation * std::max(n - 1.0f, 0.0f), MostVariance);
            age[x] = n;
        }
    });
}

bool find_rest(const Inputs& inputs, Planes& own, const Planes*& rest, RunContext& context) {
    if (knows_diffuse(inputs)) {
        rest = &inputs.mean(Channel::LowVariance);
        return true;
    }
    shape(own, inputs, 3);
    rest = &own;
    return for_rows(context, inputs.height, [&](std::uint32_t y) {
        for (std::uint32_t c = 0; c < 3; ++c) {
            const float* all = inputs.mean(Channel::Radiance).row(c, y);
            const float* light = inputs.mean(Channel::Irradiance).row(c, y);
            const float* a = inputs.mean(Channel::Albedo).row(c, y);
            float* __restrict out = own.row(c, y);
            for (std::size_t x = 0; x < inputs.width; ++x) out[x] = all[x] - a[x] * light[x];
        }
    });
}

bool take_rest(const Inputs& inputs, const Planes& rest, State& state, RunContext& context) {
    const bool known = knows_diffuse(inputs);
    const Planes& variance = inputs.variance(known ? Channel::LowVariance : Channel::Radiance);
    return for_rows(context, inputs.height, [&](std::uint32_t y) {
        const std::size_t width = inputs.width;
        for (std::uint32_t c = 0; c < 3; ++c) std::copy_n(rest.row(c, y), width, state.color.row(c, y));
        const float *red = rest.row(0, y), *green = rest.row(1, y), *blue = rest.row(2, y);
        const float *vr = variance.row(0, y), *vg = variance.row(1, y), *vb = variance.row(2, y);
        const float* counts = inputs.counts.row(0, y);
        float* __restrict l = state.moments.row(MeanLuminance, y);
        float* __restrict v = state.moments.row(SampleVariance, y);
        float* __restrict age = state.moments.row(Age, y);
        std::fill_n(state.color.row(OwnWeightComponent, y), width, 1.0f);
        for (std::size_t x = 0; x < width; ++x) {
            const float deviation = luma_deviation(vr[x], vg[x], vb[x]);
            l[x] = luma(red[x], green[x], blue[x]);
            v[x] = std::min(deviation * deviation * std::max(counts[x] - 1.0f, 0.0f), MostVariance);
            age[x] = counts[x];
        }
    });
}

}  // namespace tessera::filter::svgf
