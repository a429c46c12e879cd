#include "master/filter/bilateral.h"

#include <cmath>

#include "master/filter/features.h"
#include "master/filter/kernels.h"
#include "master/filter/window_sum.h"

namespace tessera::filter {

namespace {

using frame::Channel;

enum Parameters : std::size_t { Sigma, SigmaAlbedo, SigmaNormal, SigmaDepth, Demodulate };

class Bilateral final : public Filter {
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
        {
            const bool demodulate = values[Demodulate] == 1.0;
            PassTimer timer(report, "features",
                            Features::bytes_per_pixel(components, demodulate) + Features::GuideBytes);
            if (!features_.prepare(inputs, demodulate, context)) return false;
            const std::array scales{scale_of(values[SigmaAlbedo]), scale_of(values[SigmaNormal]),
                                    scale_of(values[SigmaDepth])};
            if (!features_.guides(inputs, DepthGuide::Logarithm, scales, guides_, context)) return false;
        }
        PassTimer timer(report, "window", 4.0 * (GuideCount + 1 + 2 * components));
        const float sigma = static_cast<float>(values[Sigma]);
        return components == 4 ? blur<4>(sigma, out.picture, context) : blur<3>(sigma, out.picture, context);
    }

    template <std::uint32_t Components>
    bool blur(float sigma, Planes& picture, RunContext& context) {
        using Sum = WindowSum<GuideCount, Components>;
        const auto radius = static_cast<std::int64_t>(std::ceil(2.5f * sigma));
        kernel_.resize(static_cast<std::size_t>(radius) + 1);
        for (std::int64_t i = 0; i <= radius; ++i) {
            const float t = static_cast<float>(i) / sigma;
            kernel_[static_cast<std::size_t>(i)] = exp_negative(-0.5f * t * t);
        }
        return for_rows(context, picture.height(), [&](std::uint32_t y) {
            Sum sum(guides_, features_.color(), features_.known());
            sum_windows(sum, y, picture, [&] {
                for (std::int64_t dy = -radius; dy <= radius; ++dy) {
                    const float across = kernel_[static_cast<std::size_t>(std::abs(dy))];
                    for (std::int64_t dx = -radius; dx <= radius; ++dx) {
                        sum.tap(dx, dy, across * kernel_[static_cast<std::size_t>(std::abs(dx))]);
                    }
                    sum.close_part();
                }
            });
            features_.finish_row(picture, y);
        });
    }

    Features features_;
    Planes guides_;
    std::vector<float> kernel_;
};

}  // namespace

FilterEntry bilateral_entry() {
    return {{.name = "bilateral",
             .summary = "cross-bilateral filter: Gaussian weights of albedo, normal and depth",
             .source = "Eisemann 2004",
             .bytes_per_pixel = 72,
             .parameters =
                 {{"sigma", "px", "spatial standard deviation", 3.0, 0.1, 16.0, {}},
                  {"sigma_albedo", "", "standard deviation in albedo", 0.05, 1e-3, 1e3, {}},
                  {"sigma_normal",
                   "",
                   "standard deviation of the difference of unit normals",
                   0.15,
                   1e-3,
                   1e3,
                   {}},
                  {"sigma_depth", "of the depth", "standard deviation in depth", 0.05, 1e-4, 1e3, {}},
                  {"demodulate", "", "divide radiance by albedo before filtering", 0, 0, 1, {"off", "on"}}},
             .channels =
                 [](const Values&) {
                     return frame::ChannelSet{Channel::Radiance, Channel::Albedo, Channel::Normal,
                                              Channel::Depth};
                 }},
            [](std::uint32_t, std::uint32_t) -> std::unique_ptr<Filter> {
                return std::make_unique<Bilateral>();
            }};
}

}  // namespace tessera::filter
