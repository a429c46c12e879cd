#include "master/filter/pixel.h"

#include <algorithm>
#include <utility>

#include "master/filter/convergence_blend.h"
#include "master/filter/kernels.h"
#include "master/filter/pixel/compose.h"
#include "master/filter/pixel/plane_filters.h"
#include "master/filter/pixel/schedule.h"
#include "master/filter/pixel/width_estimate.h"
#include "master/filter/pixel/widths.h"

namespace tessera::filter {

namespace {

using frame::Channel;
using namespace pixel;

enum Parameters : std::size_t {
    Threshold,
    SigmaSpatial,
    SigmaColor,
    SigmaDepth,
    SigmaNormal,
    MethodChoice,
    IterationCount,
    RootChoice,
    Adaptive,
    AdaptiveClamp,
    SpikeClamp,
    AntialiasRecovery,
    Normals,
    Schedule,
    UseConvergenceBlend,
    LightChoice,
    ColorMetricChoice,
    DepthMetricChoice,
};

float number(const Values& values, Parameters which) {
    return static_cast<float>(values[which]);
}

bool is_on(const Values& values, Parameters which) {
    return values[which] > 0.5;
}

// reduction_ratio by sigma: it changes below 4 pixels.
class ReductionRatios {
  public:
    void fit(int iterations) {
        if (iterations == iterations_) return;
        iterations_ = iterations;
        for (std::size_t i = 0; i < ratios_.size(); ++i) {
            ratios_[i] =
                static_cast<float>(reduction_ratio(std::max(0.01, PerPixel * double(i)), iterations));
        }
    }
    float at(float sigma) const {
        const auto i = static_cast<std::size_t>(sigma * (1.0f / PerPixel) + 0.5f);
        return ratios_[std::min(i, ratios_.size() - 1)];
    }

  private:
    static constexpr float PerPixel = 0.125f;
    int iterations_ = 0;
    std::array<float, 33> ratios_{};
};

class PixelFilter final : public Filter {
  public:
    Report run(const Inputs& inputs, const Values& values, Output& out, RunContext context) override {
        Report report;
        note_missing(inputs, values, report);
        shape(out.picture, inputs, inputs.color_components());
        const std::uint64_t samples = median_count(inputs.counts.plane(0));
        const bool pass = needs_pass(inputs, values, samples);
        const bool shown = pass || has_pass_;
        {
            PassTimer timer(report, "light", 4.0 * (3 + 9));  // counts are read three times
            holes_.find(inputs);
            light_.prepare(inputs, holes_, static_cast<LightScope>(values[LightChoice]), context);
        }
        bool done = true;
        if (pass) {
            has_pass_ = false;
            done = filter(inputs, values, report, context);
            has_pass_ = done;
            values_ = values;
            samples_ = samples;
        }
        if (done && !shown) report.notes.push_back("unfiltered: the schedule starts at 4 samples");
        if (done) done = shown ? blend(inputs, values, report, out, context) : show_unfiltered(inputs, out);
        if (done && shown && is_on(values, UseConvergenceBlend))
            done = blend_converged(inputs, report, out, context);
        report.stopped = !done;
        return report;
    }

    void reset() override { has_pass_ = false; }

  private:
    static void note_missing(const Inputs& inputs, const Values& values, Report& report) {
        if (!is_on(values, LightChoice) && !inputs.has(Channel::HighVariance))
            report.notes.push_back("channel 'high_variance' is missing: all light is filtered");
        if (!inputs.has(Channel::Headlight))
            report.notes.push_back("channel 'headlight' is missing: only depth guides the filter");
    }

    bool needs_pass(const Inputs& inputs, const Values& values, std::uint64_t samples) const {
        if (!is_on(values, Schedule)) return true;
        const bool other = !has_pass_ || field_.values.width() != inputs.width ||
                           field_.values.height() != inputs.height || inputs.changes.film_restarted ||
                           inputs.changes.geometry || inputs.changes.lights_or_materials ||
                           samples < samples_;
        if (other) return samples >= FirstPass;
        return values != values_ || filter_due(samples, samples_);
    }

    bool filter(const Inputs& inputs, const Values& values, Report& report, RunContext& context) {
        const bool with_normals = is_on(values, Normals);
        const auto layers =
            4.0 + (inputs.has(Channel::Alpha) ? 1.0 : 0.0) + (light_.has_uneven_counts() ? 1.0 : 0.0);
        {
            const double guide = 2.0 * (with_normals ? 7 : 4), field = 7.0 + layers + 1.0;
            PassTimer timer(report, "guide", 4.0 * (guide + field));
            const Tolerance tolerance{number(values, SigmaColor), number(values, SigmaDepth),
                                      with_normals ? number(values, SigmaNormal) : 0.0f,
                                      static_cast<ColorMetric>(values[ColorMetricChoice]),
                                      static_cast<DepthMetric>(values[DepthMetricChoice])};
            guide_.prepare(inputs, holes_, tolerance, context);
            light_.fill(inputs, holes_, field_, context);
            scratch_.fit(inputs.width, inputs.height, field_.values.components(), field_.weighted);
        }
        if (!choose_widths(inputs, values, report, context)) return false;
        PassTimer timer(report, "filter", bytes_of_filter(values, layers));
        if (!run_method(values, context)) return false;
        light_.divide_by_counts(inputs, holes_, field_, context);
        if (field_.weighted) return true;  // the variance is that of one sample
        return for_rows(context, inputs.height, [&](std::uint32_t y) {
            float* variance = field_.values.row(Field::Variance, y);
            const float* n = inputs.counts.row(0, y);
            for (std::uint32_t x = 0; x < inputs.width; ++x) variance[x] *= std::max(n[x], 1.0f);
        });
    }

    bool choose_widths(const Inputs& inputs, const Values& values, Report& report, RunContext& context) {
        const float sigma = number(values, SigmaSpatial);
        if (is_on(values, Adaptive) && values[MethodChoice] != double(Method::ATrous)) {
            PassTimer timer(report, "widths", WidthEstimate::BytesPerPixel);
            const AdaptiveWidths rule{number(values, Threshold), sigma, number(values, AdaptiveClamp)};
            return width_estimate_.run(guide_, light_, inputs, field_, rule, widths_, strips_, context);
        }
        widths_.fit(inputs.width, inputs.height, 1);
        return for_rows(context, inputs.height,
                        [&](std::uint32_t y) { std::fill_n(widths_.row(0, y), inputs.width, sigma); });
    }

    bool run_method(const Values& values, RunContext& context) {
        switch (static_cast<Method>(values[MethodChoice])) {
            case Method::Brute:
                return filter_brute_force(guide_, widths_, field_, scratch_, context);
            case Method::ATrous:
                return filter_atrous(guide_, number(values, SigmaSpatial), field_, scratch_, context);
            case Method::Separable:
                break;
        }
        const int iterations = static_cast<int>(values[IterationCount]);
        const Edges edges = is_on(values, AntialiasRecovery) ? Edges::Recover : Edges::Keep;
        if (!filter_separable(guide_, widths_, iterations, edges, field_, scratch_, strips_, context))
            return false;
        ratios_.fit(iterations);
        return for_rows(context, field_.values.height(), [&](std::uint32_t y) {
            float* reduction = field_.reduction.row(0, y);
            const float* sigma = widths_.row(0, y);
            for (std::uint32_t x = 0; x < field_.values.width(); ++x) reduction[x] *= ratios_.at(sigma[x]);
        });
    }

    // Each sweep reads guide, values, r and width and writes values and r.
    double bytes_of_filter(const Values& values, double layers) const {
        const double sweep = 4.0 * (guide_.components() + 2.0 * (layers + 1.0) + 1.0);
        switch (static_cast<Method>(values[MethodChoice])) {
            case Method::Brute:
                return sweep + 8.0;
            case Method::ATrous:
                return 3.0 * sweep + 16.0;
            case Method::Separable:
                break;
        }
        return 2.0 * values[IterationCount] * sweep + 20.0;
    }

    bool blend(const Inputs& inputs, const Values& values, Report& report, Output& out, RunContext& context) {
        const std::uint32_t components = inputs.color_components();
        PassTimer timer(report, "blend", 4.0 * (3.0 * 3 + components + 3 + components + 1));
        const Blend how{number(values, Threshold), static_cast<Root>(values[RootChoice]),
                        number(values, SpikeClamp)};
        BlendMaps maps;
        if (out.wants_maps) maps = prepare_maps(inputs, out);
        shape(self_weight_, inputs, 1);
        maps.self_weight = &self_weight_;
        return compose(inputs, light_, field_, how, out.picture, maps, context);
    }

    // Only the high-variance light was filtered, so the blend uses its variance.
    bool blend_converged(const Inputs& inputs, Report& report, Output& out, RunContext& context) {
        PassTimer timer(report, "convergence blend",
                        ConvergenceBlend::bytes_per_pixel(inputs.color_components()));
        return convergence_blend_.apply(inputs, light_.channel(), self_weight_.plane(0), out.picture,
                                        context);
    }

    BlendMaps prepare_maps(const Inputs& inputs, Output& out) const {
        constexpr std::array Names{"headlight", "variance", "smoothed_variance",
                                   "blend",     "width",    "reduction"};
        out.maps.resize(Names.size());
        for (std::size_t i = 0; i < Names.size(); ++i) {
            out.maps[i].name = Names[i];
            shape(out.maps[i].planes, inputs, i == 0 ? 3 : 1);
        }
        if (inputs.has(Channel::Headlight)) out.maps[0].planes = inputs.mean(Channel::Headlight);
        const Planes& variance = inputs.variance(light_.channel());
        for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
            out.maps[1].planes.plane(0)[i] =
                luminance_variance(variance.plane(0)[i], variance.plane(1)[i], variance.plane(2)[i]);
        }
        for (std::uint32_t y = 0; y < inputs.height; ++y) {
            std::copy_n(widths_.row(0, y), inputs.width, out.maps[4].planes.row(0, y));
            std::copy_n(field_.reduction.row(0, y), inputs.width, out.maps[5].planes.row(0, y));
        }
        return {&out.maps[2].planes, &out.maps[3].planes};
    }

    bool show_unfiltered(const Inputs& inputs, Output& out) const {
        for (std::uint32_t c = 0; c < inputs.color_components(); ++c) {
            std::ranges::copy(inputs.color(c), out.picture.plane(c).begin());
        }
        return true;
    }

    Planes self_weight_;  // in the blended picture
    Holes holes_;
    Light light_;
    Guide guide_;
    WidthEstimate width_estimate_;
    Widths widths_;
    Field field_, scratch_;  // field_: of the last pass
    Strips strips_;
    ReductionRatios ratios_;
    ConvergenceBlend convergence_blend_;

    bool has_pass_ = false;  // field_ holds the result of a pass with these inputs:
    Values values_;
    std::uint64_t samples_ = 0;
};

Parameter one_of(std::string_view name, std::string_view meaning, double initial,
                 std::vector<std::string_view> names) {
    const auto last = static_cast<double>(names.size() - 1);
    return {name, "", meaning, initial, 0, last, std::move(names)};
}

std::vector<Parameter> pixel_parameters() {
    return {
        {"t",
         "",
         "accepted perceived variance (0.01: a deviation of a tenth of the surrounding light)",
         0.01,
         1e-6,
         10.0,
         {}},
        {"sigma_s", "px", "standard deviation of the spatial kernel", 8.0, 0.5, 32.0, {}},
        {"sigma_c", "", "standard deviation in headlight colour", 0.02, 1e-4, 10.0, {}},
        {"sigma_d", "m", "standard deviation in depth", 2.0, 1e-6, 1e9, {}},
        {"sigma_n", "", "standard deviation of the difference of normals", 0.2, 1e-3, 10.0, {}},
        one_of("method",
               "separable: fast; brute: brute force, the reference; atrous: three sparse iterations", 0,
               {"separable", "brute", "atrous"}),
        {"iterations", "", "of the separable method", 3, 1, 5, {}},
        one_of("root", "blend factor without or with the covariance of both pictures", 1,
               {"simple", "covariance"}),
        one_of("adaptive", "kernel widths per pixel by variance (not atrous)", 1, {"off", "on"}),
        {"adaptive_clamp", "", "widths within this factor of sigma_s / sqrt(n)", 4.0, 1.0, 64.0, {}},
        {"spike_clamp",
         "",
         "unfiltered light within this factor of the filtered; 0: no clamp",
         2.0,
         0.0,
         1e6,
         {}},
        one_of("aa_recovery", "reconstruct antialiased edges as a mixture of both sides (separable only)", 1,
               {"off", "on"}),
        one_of("normals", "use normals as an additional guide", 0, {"off", "on"}),
        one_of("schedule", "filter only at 4, 8, 16, ... samples; only blend in between", 0, {"off", "on"}),
        one_of("blend", "blend back to the samples where filtering would increase the error", 1,
               {"off", "on"}),
        one_of("light",
               "filtered light: the view's path class, or all of it, where direct light is noisy, too", 0,
               {"path_class", "all"}),
        one_of("color_metric", "headlight colours are compared in linear RGB, or in CIELAB / 100", 0,
               {"linear", "lab"}),
        one_of("depth_metric",
               "depths are compared in metres, or by their ratio: sigma_d of its logarithm, such as 0.1", 0,
               {"absolute", "relative"})};
}

}  // namespace

FilterEntry pixel_entry() {
    return {{.name = "pixel",
             .summary = "cross-bilateral filter of the high-variance light, blended by perceived variance",
             .source = "Schwenk 3",
             .bytes_per_pixel = 288,
             .parameters = pixel_parameters(),
             .channels =
                 [](const Values& values) {
                     frame::ChannelSet channels{Channel::Radiance, Channel::Depth, Channel::Headlight};
                     if (!is_on(values, LightChoice)) {
                         channels.insert(Channel::LowVariance);
                         channels.insert(Channel::HighVariance);
                     }
                     if (is_on(values, Normals)) channels.insert(Channel::Normal);
                     return channels;
                 },
             .consistent = true,
             .reads_variances = true,
             .incremental = true},
            [](std::uint32_t, std::uint32_t) -> std::unique_ptr<Filter> {
                return std::make_unique<PixelFilter>();
            }};
}

}  // namespace tessera::filter
