#include "master/filter/fdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "master/filter/convergence_blend.h"
#include "master/filter/fdf/feature_bilateral.h"
#include "master/filter/fdf/nl_means.h"
#include "master/filter/kernels.h"
#include "master/filter/self_weight.h"
#include "master/filter/svgf/hole_fill.h"
#include "mediator/base/random.h"

namespace tessera::filter {

namespace {

using frame::Channel;

enum Parameters : std::size_t {
    Radius,
    TMax,
    NMax,
    SMax,
    Nlm,
    NlmRadius,
    Patch,
    K,
    Prefilter,
    UseConvergenceBlend,
    Demodulate
};

constexpr float Hole = static_cast<float>(PixelClass::Hole);
constexpr float Surface = static_cast<float>(PixelClass::Surface);
constexpr float Background = static_cast<float>(PixelClass::Background);

// The variance between pixels of one class around (x, y).
float local_variance(const Planes& values, const Planes& classes, std::uint32_t x, std::uint32_t y) {
    double sum = 0.0, squares = 0.0, count = 0.0;
    const std::uint32_t x0 = x > 2 ? x - 2 : 0, x1 = std::min(values.width() - 1, x + 2);
    const std::uint32_t y0 = y > 2 ? y - 2 : 0, y1 = std::min(values.height() - 1, y + 2);
    for (std::uint32_t j = y0; j <= y1; ++j) {
        for (std::uint32_t i = x0; i <= x1; ++i) {
            if (classes.row(0, j)[i] != classes.row(0, y)[x]) continue;
            const double v = values.row(0, j)[i];
            sum += v;
            squares += v * v;
            count += 1.0;
        }
    }
    return static_cast<float>(std::max(0.0, squares / count - sum * sum / (count * count)));
}

class Fdf final : public Filter {
  public:
    Report run(const Inputs& inputs, const Values& values, Output& out, RunContext context) override {
        Report report;
        const std::uint32_t components = inputs.color_components();
        for (Planes* planes : {&classes_, &shading_, &variance_, &filtered_, &self_}) {
            shape(*planes, inputs, 1);
        }
        probes_ = values[UseConvergenceBlend] != 0.0 && inputs.has(Channel::ShadingFeature);
        shape(out.picture, inputs, components);
        report.stopped = !prepare(inputs, report, context) || !prefilter(inputs, values, report, context) ||
                         !filter(inputs, values, out, report, context) ||
                         !fill_holes(inputs, out.picture, report, context);
        return report;
    }

  private:
    // The samples' noise is also in the shading, so that the filter follows it more than its own weight says: a pixel
    // that happened to be bright looks similar to brighter ones. How much is measured by another run, in an eighth of them,
    // with noise of random sign added to both.
    void prepare_probe(const Inputs& inputs, RunContext& context) {
        for (Planes* planes : {&signs_, &moved_, &moved_filtered_, &change_, &response_})
            shape(*planes, inputs, 1);
        for_rows(context, inputs.height, [&](std::uint32_t y) {
            float *signs = signs_.row(0, y), *moved = moved_.row(0, y);
            const float* variance = variance_.row(0, y);
            for (std::uint32_t x = 0; x < inputs.width; ++x) {
                signs[x] = mix(std::uint64_t{y} << 32 | x) & 1 ? 1.0f : -1.0f;
                moved[x] = signs[x] * std::sqrt(variance[x]);
            }
        });
    }

    // Classes, and the shading feature and its variance in units of its mean.
    bool prepare(const Inputs& inputs, Report& report, RunContext& context) {
        PassTimer timer(report, "features", 44.0);
        const bool has_alpha = inputs.has(Channel::Alpha), has_depth = inputs.has(Channel::Depth);
        const bool has_shading = inputs.has(Channel::ShadingFeature);
        if (!has_shading) report.notes.push_back("no shading feature: shadows are not preserved");
        sums_.assign(inputs.height, {});
        const bool done = for_rows(context, inputs.height, [&](std::uint32_t y) {
            const float* counts = inputs.counts.row(0, y);
            float* classes = classes_.row(0, y);
            RowSum sum;
            for (std::uint32_t x = 0; x < inputs.width; ++x) {
                const bool hit = has_alpha   ? inputs.mean(Channel::Alpha).row(0, y)[x] > 0.0f
                                 : has_depth ? std::isfinite(inputs.mean(Channel::Depth).row(0, y)[x])
                                             : true;
                classes[x] = counts[x] == 0.0f ? Hole : hit ? Surface : Background;
                sum.holes += counts[x] == 0.0f;
            }
            sums_[y] = sum;
        });
        holes_ = 0;
        for (const RowSum& row : sums_) holes_ += row.holes;
        return done && has_shading ? normalise(inputs, mean_shading(inputs, context), context) : done;
    }

    // Over surfaces without directly seen lamps, whose own emission is no shading: a small one that is far
    // brighter than the room would make every difference in it look small, and shadows would be blurred. A
    // single sample that found much light is as bright, but its variance shows it. Windows of interiors have 20 to
    // 200 times the median: leaving them out keeps more specks.
    double mean_shading(const Inputs& inputs, RunContext& context) {
        constexpr float Brighter = 200.0f, Certain = 1.0f / 16.0f;
        const float most = Brighter * median_shading(inputs);
        for_rows(context, inputs.height, [&](std::uint32_t y) {
            const float* light = inputs.mean(Channel::ShadingFeature).row(0, y);
            const float* variance = inputs.variance(Channel::ShadingFeature).row(0, y);
            const float *counts = inputs.counts.row(0, y), *classes = classes_.row(0, y);
            RowSum sum;
            for (std::uint32_t x = 0; x < inputs.width; ++x) {
                const float s = light[x];
                const bool lamp = s > most && counts[x] >= 2.0f && variance[x] < Certain * s * s;
                if (classes[x] != Surface || lamp) continue;
                sum.light += s;
                sum.count += 1.0;
            }
            sums_[y] = sum;
        });
        RowSum total;
        for (const RowSum& row : sums_) {
            total.light += row.light;
            total.count += row.count;
        }
        return total.light > 0.0 ? std::max(total.light / total.count, 1e-30) : 1.0;
    }

    // Of the surfaces that are not black, at about 4096 pixels. Infinite if there are none.
    float median_shading(const Inputs& inputs) {
        constexpr std::size_t Most = 4096;
        const std::span<const float> light = inputs.mean(Channel::ShadingFeature).plane(0);
        const std::size_t step =
            (inputs.pixel_count() / Most + 1) | 1;  // odd: does not alias with even widths
        surfaces_.clear();
        surfaces_.reserve(Most);
        for (std::size_t i = 0; i < inputs.pixel_count(); i += step) {
            if (classes_.plane(0)[i] == Surface && light[i] > 0.0f) surfaces_.push_back(light[i]);
        }
        if (surfaces_.empty()) return std::numeric_limits<float>::infinity();
        const auto middle = surfaces_.begin() + static_cast<std::ptrdiff_t>(surfaces_.size() / 2);
        std::ranges::nth_element(surfaces_, middle);
        return *middle;
    }

    bool normalise(const Inputs& inputs, double mean, RunContext& context) {
        const Planes& light = inputs.mean(Channel::ShadingFeature);
        const Planes& variance = inputs.variance(Channel::ShadingFeature);
        return for_rows(context, inputs.height,
                        [&](std::uint32_t y) {
                            for (std::uint32_t x = 0; x < inputs.width; ++x) {
                                const double s = light.row(0, y)[x] / mean;
                                const double v = variance.row(0, y)[x] / mean / mean;
                                shading_.row(0, y)[x] = static_cast<float>(std::clamp(s, 0.0, 1e9));
                                variance_.row(0, y)[x] = static_cast<float>(std::min(v, 1e18));
                            }
                        }) &&
               for_rows(context, inputs.height, [&](std::uint32_t y) {
                   const float* counts = inputs.counts.row(0, y);
                   for (std::uint32_t x = 0; x < inputs.width; ++x) {
                       if (counts[x] > 0.0f && counts[x] < 2.0f) {
                           variance_.row(0, y)[x] = local_variance(shading_, classes_, x, y);
                       }
                   }
               });
    }

    bool prefilter(const Inputs& inputs, const Values& values, Report& report, RunContext& context) {
        if (probes_) prepare_probe(inputs, context);
        prefiltered_ = values[Prefilter] != 0.0 && inputs.has(Channel::ShadingFeature);
        if (!prefiltered_) return !context.stop.stop_requested();
        PassTimer timer(report, "nl-means", 16.0);
        const NlmSettings settings{.form = values[Nlm] == 0.0 ? NlmForm::Standard : NlmForm::Thesis,
                                   .radius = static_cast<std::uint32_t>(values[NlmRadius]),
                                   .patch = static_cast<std::uint32_t>(values[Patch]),
                                   .k = static_cast<float>(values[K])};
        if (!probes_) return nl_means_.run(shading_, variance_, classes_, settings, filtered_, context);
        return nl_means_.run(shading_, variance_, classes_, settings, filtered_, context, &moved_,
                             &moved_filtered_);
    }

    bool filter(const Inputs& inputs, const Values& values, Output& out, Report& report,
                RunContext& context) {
        const std::uint32_t components = inputs.color_components();
        const FeatureSettings settings{
            .radius = static_cast<std::uint32_t>(values[Radius]),
            .t_max = static_cast<float>(values[TMax]),
            .n_max = static_cast<float>(values[NMax]),
            .s_max = static_cast<float>(values[SMax]),
            .demodulation = values[Demodulate] != 0.0 ? Demodulation::On : Demodulation::Off};
        {
            PassTimer timer(report, "bilateral", 4.0 * (6 + 3 + 2 * components + 1 + (probes_ ? 6 : 0)));
            const Probe probe{signs_, prefiltered_ ? moved_filtered_ : moved_, change_, response_};
            if (!bilateral_.run(inputs, prefiltered_ ? filtered_ : shading_, classes_, settings, out.picture,
                                self_, context, probes_ ? &probe : nullptr)) {
                return false;
            }
        }
        if (values[UseConvergenceBlend] == 0.0) return true;
        PassTimer timer(report, "convergence blend", ConvergenceBlend::bytes_per_pixel(components));
        if (probes_ && !weigh_own(inputs, out.picture, context)) return false;
        return convergence_blend_.apply(inputs, Channel::Radiance, self_.plane(0), out.picture, context);
    }

    // A pixel without similar neighbours keeps its samples, whatever the pixels around it do.
    bool weigh_own(const Inputs& inputs, const Planes& picture, RunContext& context) {
        if (!self_weight_.run(inputs, change_.plane(0), {}, response_.plane(0), picture, context))
            return false;
        std::ranges::transform(self_.plane(0), self_weight_.weights(), self_.plane(0).begin(),
                               [](float own, float measured) { return std::max(own, measured); });
        return true;
    }

    bool fill_holes(const Inputs& inputs, Planes& picture, Report& report, RunContext& context) {
        if (holes_ == 0) return true;
        PassTimer timer(report, "holes", 8.0 * (picture.components() + 1));
        ids_.resize(inputs.pixel_count());
        std::ranges::transform(classes_.plane(0), ids_.begin(),
                               [](float c) { return static_cast<std::uint32_t>(c); });
        std::array<svgf::PlaneView, 4> planes{};
        for (std::uint32_t c = 0; c < picture.components(); ++c) {
            planes[c] = {picture.plane(c).data(), inputs.width};
        }
        return hole_fill_.run(inputs.counts, ids_, std::span(planes).first(picture.components()), context);
    }

    struct RowSum {
        double light = 0.0, count = 0.0;
        std::size_t holes = 0;
    };
    std::vector<RowSum> sums_;
    std::vector<float> surfaces_;  // whose median is taken
    Planes classes_, shading_, variance_, filtered_, self_;
    std::vector<std::uint32_t> ids_;
    bool prefiltered_ = false, probes_ = false;
    // Of the probe: the changes of the shading, and of the prefiltered one, and those of the picture.
    Planes signs_, moved_, moved_filtered_, change_, response_;
    SelfWeight self_weight_;
    std::size_t holes_ = 0;
    NlMeans nl_means_;
    FeatureBilateral bilateral_;
    ConvergenceBlend convergence_blend_;
    svgf::HoleFill hole_fill_;
};

}  // namespace

FilterEntry fdf_entry() {
    return {
        {.name = "fdf",
         .summary = "feature distances: albedo, normal and prefiltered shading guide a bilateral mean",
         .source = "Lardinoije 4.2",
         .bytes_per_pixel = 192,
         .parameters =
             {{"radius", "px", "of the window", 8, 0, FeatureMaxRadius, {}},
              {"t_max", "", "difference of albedo at which the weight is 1/e", 0.03, 1e-4, 100, {}},
              {"n_max", "", "the same of normals mapped to (x + 1) / 2", 0.06, 1e-4, 100, {}},
              {"s_max", "", "the same of shading at one sample; falls with 1 / samples", 5, 1e-3, 1e6, {}},
              {"nlm", "", "form of the prefilter", 0, 0, 0, {"standard", "thesis"}},
              {"nlm_radius", "px", "of the prefilter's window", 5, 0, NlmMaxRadius, {}},
              {"patch", "px", "radius of the prefilter's patches", 2, 0, NlmMaxPatch, {}},
              {"k", "", "standard form: deviations that count as equal", 0.5, 0.05, 10, {}},
              {"prefilter", "", "prefilter the shading feature", 1, 0, 0, {"off", "on"}},
              {"blend",
               "",
               "blend back to the samples where filtering would increase the error",
               1,
               0,
               0,
               {"off", "on"}},
              {"demodulate", "", "divide radiance by albedo before filtering", 0, 0, 0, {"off", "on"}}},
         .channels =
             [](const Values&) {
                 return frame::ChannelSet{Channel::Radiance, Channel::Albedo, Channel::Normal,
                                          Channel::ShadingFeature, Channel::Depth};
             },
         .consistent = true,
         .reads_variances = true},
        [](std::uint32_t, std::uint32_t) -> std::unique_ptr<Filter> { return std::make_unique<Fdf>(); }};
}

}  // namespace tessera::filter
