#include "master/filter/guided.h"

#include <algorithm>

#include "master/filter/features.h"
#include "master/filter/guided/local_models.h"
#include "master/filter/kernels.h"

namespace tessera::filter {

namespace {

using frame::Channel;

enum Parameters : std::size_t { Radius, Epsilon, Demodulate };

class Guided final : public Filter {
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
                            Features::bytes_per_pixel(components, demodulate) + 2.5 * Features::GuideBytes);
            if (!features_.prepare(inputs, demodulate, context)) return false;
            if (!features_.guides(inputs, DepthGuide::Disparity, {1.0f, 1.0f, 1.0f}, guides_, context)) {
                return false;
            }
            if (!normalise(context)) return false;
        }
        PassTimer timer(report, "models",
                        4.0 * (1 + 2 * GuideCount + 2 * components + 2 * (GuideCount + 1) * components));
        const LocalModelSettings settings{.radius = static_cast<std::uint32_t>(std::lround(values[Radius])),
                                          .ridge = static_cast<float>(values[Epsilon])};
        if (!models_.run(guides_, features_.color(), features_.known(), settings, out.picture, context)) {
            return false;
        }
        return for_rows(context, inputs.height, [&](std::uint32_t y) {
            for (std::uint32_t c = 0; c < components; ++c) {
                float* row = out.picture.row(c, y);
                for (std::uint32_t x = 0; x < inputs.width; ++x) row[x] = std::max(row[x], 0.0f);
            }
            features_.finish_row(out.picture, y);
        });
    }

    // To mean 0 and variance 1 over the frame; a constant feature becomes 0.
    bool normalise(RunContext& context) {
        const std::uint32_t height = guides_.height(), width = guides_.width();
        sums_.resize(std::size_t{height} * GuideCount);
        std::array<double, GuideCount> mean{}, variance{};
        const auto gather = [&](std::array<double, GuideCount>& total, const auto& term) {
            const bool done = for_rows(context, height, [&](std::uint32_t y) {
                for (std::uint32_t g = 0; g < GuideCount; ++g) {
                    double sum = 0.0;
                    const float* row = guides_.row(g, y);
                    for (std::uint32_t x = 0; x < width; ++x) sum += term(g, row[x]);
                    sums_[std::size_t{y} * GuideCount + g] = sum;
                }
            });
            for (std::size_t i = 0; i < sums_.size(); ++i) {
                total[i % GuideCount] += sums_[i] / static_cast<double>(guides_.pixel_count());
            }
            return done;
        };
        if (!gather(mean, [](std::uint32_t, float value) { return static_cast<double>(value); }))
            return false;
        const auto square = [&](std::uint32_t g, float value) {
            const double d = static_cast<double>(value) - mean[g];
            return d * d;
        };
        if (!gather(variance, square)) return false;
        return for_rows(context, height, [&](std::uint32_t y) {
            for (std::uint32_t g = 0; g < GuideCount; ++g) {
                const bool varies = variance[g] > 1e-12 * mean[g] * mean[g] && variance[g] > 0.0;
                const auto scale = varies ? static_cast<float>(1.0 / std::sqrt(variance[g])) : 0.0f;
                const auto center = static_cast<float>(mean[g]);
                float* __restrict row = guides_.row(g, y);
                for (std::uint32_t x = 0; x < width; ++x) row[x] = (row[x] - center) * scale;
            }
        });
    }

    Features features_;
    Planes guides_;
    std::vector<double> sums_;
    LocalModels models_;
};

}  // namespace

FilterEntry guided_entry() {
    return {
        {.name = "guided",
         .summary = "guided image filter: local linear models of the picture in albedo, normal and depth",
         .source = "He 2010, Bauszat 2011",
         .bytes_per_pixel = 144,
         .parameters =
             {{"radius", "px", "of the windows", 4, 1, 32, {}},
              {"epsilon",
               "of the features' variances",
               "local variance of a feature below which it is ignored",
               1e-3,
               1e-5,
               10.0,
               {}},
              {"demodulate", "", "divide radiance by albedo before filtering", 0, 0, 1, {"off", "on"}}},
         .channels =
             [](const Values&) {
                 return frame::ChannelSet{Channel::Radiance, Channel::Albedo, Channel::Normal,
                                          Channel::Depth};
             }},
        [](std::uint32_t, std::uint32_t) -> std::unique_ptr<Filter> { return std::make_unique<Guided>(); }};
}

}  // namespace tessera::filter
