#include "master/filter/eaw.h"

#include <cmath>
#include <limits>

#include "master/filter/features.h"
#include "master/filter/kernels.h"
#include "master/filter/window_sum.h"

namespace tessera::filter {

namespace {

using frame::Channel;

enum Parameters : std::size_t { Levels, SigmaColor, SigmaNormal, SigmaDepth, Demodulate };

constexpr std::uint32_t ColorGuides = 3, SurfaceGuides = 4;
constexpr std::uint32_t Guides = ColorGuides + SurfaceGuides;
constexpr std::array<float, 3> Spline{3.0f / 8.0f, 1.0f / 4.0f, 1.0f / 16.0f};  // by distance from the centre

// Sequential, so that the bits do not depend on the number of threads.
float mean_luminance(const Features& features) {
    const Planes& color = features.color();
    const auto known = features.known().plane(0);
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < color.pixel_count(); ++i) {
        sum += static_cast<double>(known[i]) *
               luminance(color.plane(0)[i], color.plane(1)[i], color.plane(2)[i]);
        count += known[i];
    }
    return std::max(static_cast<float>(sum / std::max(count, 1.0)), std::numeric_limits<float>::min());
}

class Eaw final : public Filter {
  public:
    Report run(const Inputs& inputs, const Values& values, Output& out, RunContext context) override {
        Report report;
        report.stopped = !run(inputs, values, out, context, report);
        return report;
    }

  private:
    bool run(const Inputs& inputs, const Values& values, Output& out, RunContext& context, Report& report) {
        const std::uint32_t components = inputs.color_components();
        shape(out.picture, inputs, components);
        shape(guides_, inputs, Guides);
        {
            const bool demodulate = values[Demodulate] == 1.0;
            PassTimer timer(report, "features",
                            Features::bytes_per_pixel(components, demodulate) + Features::GuideBytes);
            if (!features_.prepare(inputs, demodulate, context)) return false;
            const std::array scales{1.0f, scale_of(values[SigmaNormal]), scale_of(values[SigmaDepth])};
            if (!features_.guides(inputs, DepthGuide::Logarithm, scales, surface_, context)) return false;
            for (std::uint32_t g = 0; g < SurfaceGuides; ++g) {
                std::ranges::copy(surface_.plane(3 + g), guides_.plane(ColorGuides + g).begin());
            }
        }
        const auto levels = static_cast<std::uint32_t>(std::lround(values[Levels]));
        const float white = mean_luminance(features_);
        const Planes* from = &features_.color();
        for (std::uint32_t level = 0; level < levels; ++level) {
            PassTimer timer(report, "level", 4.0 * (2 * ColorGuides + Guides + 1 + 2 * components));
            // The last level writes to the output picture.
            Planes& to = (levels - level) % 2 == 1 ? out.picture : between_;
            shape(to, inputs, components);
            const float scale = scale_of(values[SigmaColor]) * std::ldexp(1.0f, static_cast<int>(level));
            if (!compress(*from, white, scale, context)) return false;
            const bool done = components == 4 ? transform<4>(*from, level, to, context)
                                              : transform<3>(*from, level, to, context);
            if (!done) return false;
            from = &to;
        }
        PassTimer timer(report, "finish", 4.0 * 3 * components);
        if (levels == 0) std::ranges::copy(from->values(), out.picture.values().begin());
        return for_rows(context, inputs.height,
                        [&](std::uint32_t y) { features_.finish_row(out.picture, y); });
    }

    bool compress(const Planes& color, float white, float scale, RunContext& context) {
        return for_rows(context, color.height(), [&](std::uint32_t y) {
            for (std::uint32_t c = 0; c < ColorGuides; ++c) {
                const float* from = color.row(c, y);
                float* __restrict to = guides_.row(c, y);
                for (std::uint32_t x = 0; x < color.width(); ++x) {
                    to[x] = scale * (from[x] / (from[x] + white));
                }
            }
        });
    }

    template <std::uint32_t Components>
    bool transform(const Planes& from, std::uint32_t level, Planes& to, RunContext& context) {
        using Sum = WindowSum<Guides, Components>;
        const std::int64_t step = std::int64_t{1} << level;
        return for_rows(context, to.height(), [&](std::uint32_t y) {
            Sum sum(guides_, from, features_.known());
            sum_windows(sum, y, to, [&] {
                for (std::int64_t dy = -2; dy <= 2; ++dy) {
                    const float across = Spline[static_cast<std::size_t>(std::abs(dy))];
                    for (std::int64_t dx = -2; dx <= 2; ++dx) {
                        sum.tap(step * dx, step * dy,
                                across * Spline[static_cast<std::size_t>(std::abs(dx))]);
                    }
                }
                sum.close_part();
            });
        });
    }

    Features features_;
    Planes guides_, surface_, between_;
};

}  // namespace

FilterEntry eaw_entry() {
    return {{.name = "eaw",
             .summary = "edge-avoiding a-trous wavelets, guided by colour, normal and depth",
             .source = "Dammertz 2010",
             .bytes_per_pixel = 116,
             .parameters =
                 {{"levels", "", "levels; the taps of level i are 2^i pixels apart", 5, 0, 8, {}},
                  {"sigma_color",
                   "of colour / (colour + mean luminance)",
                   "standard deviation in colour at the first level; halves at each next",
                   1.0,
                   1e-3,
                   1e3,
                   {}},
                  {"sigma_normal",
                   "",
                   "standard deviation of the difference of unit normals",
                   0.15,
                   1e-3,
                   1e3,
                   {}},
                  {"sigma_depth", "of the depth", "standard deviation in depth", 0.05, 1e-4, 1e3, {}},
                  {"demodulate", "", "divide radiance by albedo before filtering", 1, 0, 1, {"off", "on"}}},
             .channels =
                 [](const Values& values) {
                     frame::ChannelSet channels{Channel::Radiance, Channel::Normal, Channel::Depth};
                     if (values[Demodulate] == 1.0) channels.insert(Channel::Albedo);
                     return channels;
                 }},
            [](std::uint32_t, std::uint32_t) -> std::unique_ptr<Filter> { return std::make_unique<Eaw>(); }};
}

}  // namespace tessera::filter
