#include "master/filter/nlm.h"

#include <algorithm>

#include "master/filter/features.h"
#include "master/filter/kernels.h"
#include "master/filter/nlm/color_nl_means.h"
#include "master/filter/nlm/pyramid.h"

namespace tessera::filter {

namespace {

using frame::Channel;

enum Parameters : std::size_t { Radius, Patch, K, Scales, Demodulate };

constexpr std::uint32_t MostScales = 4;
constexpr float MostColor = 1e18f, MostVariance = 1e37f;
constexpr std::uint32_t VarianceRadius = 3;  // neighbourhood for pixels with one sample
constexpr std::uint32_t VarianceBlur = 1;

class Nlm final : public Filter {
  public:
    Report run(const Inputs& inputs, const Values& values, Output& out, RunContext context) override {
        Report report;
        report.stopped = !run(inputs, values, out, context, report);
        return report;
    }

  private:
    struct Level {
        Planes match, color, known, variance, filtered, halved;
    };

    bool run(const Inputs& inputs, const Values& values, Output& out, RunContext& context, Report& report) {
        const std::uint32_t components = inputs.color_components();
        const auto scales = static_cast<std::uint32_t>(std::lround(values[Scales]));
        ColorNlMeansSettings settings{
            .radius = static_cast<std::uint32_t>(std::lround(values[Radius])),
            .patch = static_cast<std::uint32_t>(std::lround(values[Patch])),
            .k = static_cast<float>(values[K]),
        };
        {
            const bool demodulate = values[Demodulate] == 1.0;
            PassTimer timer(report, "features", Features::bytes_per_pixel(components, demodulate) + 60.0);
            if (!features_.prepare(inputs, demodulate, context)) return false;
            if (!estimate_variance(inputs, context)) return false;
        }
        {
            PassTimer timer(report, "halve", 8.0 * (components + 6) * 4.0 / 3.0);
            for (std::uint32_t s = 0; s < scales; ++s) {
                if (!make_level(s, context)) return false;
            }
        }
        settings.epsilon = epsilon();
        for (std::uint32_t s = 0; s < scales; ++s) {
            PassTimer timer(report, "window",
                            4.0 * (4 + 1 + 2 * components) / static_cast<double>(1u << (2 * s)));
            Level& level = levels_[s];
            Planes& filtered = s == 0 ? out.picture : level.filtered;
            if (!windows_[s].run(level.match, color_of(s), known_of(s), settings, filtered, context))
                return false;
        }
        PassTimer timer(report, "combine", 4.0 * 4 * components);
        for (std::uint32_t s = scales - 1; s-- > 0;) {
            Planes& finer = s == 0 ? out.picture : levels_[s].filtered;
            halve(finer, levels_[s + 1].halved, context);
            add_difference(levels_[s + 1].filtered, levels_[s + 1].halved, finer, context);
        }
        return for_rows(context, inputs.height, [&](std::uint32_t y) {
            for (std::uint32_t c = 0; c < components; ++c) {
                float* row = out.picture.row(c, y);
                for (std::uint32_t x = 0; x < inputs.width; ++x) row[x] = std::max(row[x], 0.0f);
            }
            features_.finish_row(out.picture, y);
        });
    }

    const Planes& color_of(std::uint32_t s) const { return s == 0 ? features_.color() : levels_[s].color; }
    const Planes& known_of(std::uint32_t s) const { return s == 0 ? features_.known() : levels_[s].known; }

    // Relative to the squared picture, so that equal pixels of a noise-free picture count as equal.
    float epsilon() const {
        const Planes& match = levels_[0].match;
        double sum = 0.0;
        for (std::uint32_t c = 0; c < 3; ++c) {
            for (const float value : match.plane(c)) sum += static_cast<double>(value) * value;
        }
        const double mean = sum / static_cast<double>(match.pixel_count());
        return static_cast<float>(std::clamp(1e-8 * mean, 1e-37, 1e30));
    }

    // The sum of the variances of r, g, b.
    bool estimate_variance(const Inputs& inputs, RunContext& context) {
        shape(rough_, inputs, 1);
        shape(moments_, inputs, 4);
        const Planes& variance = inputs.variance(Channel::Radiance);
        const Planes& color = features_.color();
        const bool done = for_rows(context, inputs.height, [&](std::uint32_t y) {
            float* __restrict second = moments_.row(3, y);
            std::fill_n(second, inputs.width, 0.0f);
            for (std::uint32_t c = 0; c < 3; ++c) {
                const float* from = color.row(c, y);
                float* __restrict first = moments_.row(c, y);
                for (std::uint32_t x = 0; x < inputs.width; ++x) {
                    first[x] = std::min(std::max(from[x], -MostColor), MostColor);
                    second[x] += first[x] * first[x];
                }
            }
        });
        if (!done) return false;
        box_mean(moments_, VarianceRadius, scratch_, around_, context);
        const bool estimated = for_rows(context, inputs.height, [&](std::uint32_t y) {
            float* to = rough_.row(0, y);
            std::fill_n(to, inputs.width, 0.0f);
            for (std::uint32_t c = 0; c < 3; ++c) {
                row_variance(variance.row(c, y), c, y, inputs.width, to);
            }
            features_.fill_row(inputs.counts.row(0, y), y, moments_.row(0, y));
            const float* counts = moments_.row(0, y);
            const float *m0 = around_.row(0, y), *m1 = around_.row(1, y), *m2 = around_.row(2, y);
            const float* second = around_.row(3, y);
            for (std::uint32_t x = 0; x < inputs.width; ++x) {
                const float spread =
                    std::max(second[x] - (m0[x] * m0[x] + m1[x] * m1[x] + m2[x] * m2[x]), 0.0f);
                to[x] = std::min(counts[x] < 2.0f ? spread : to[x], MostVariance);
            }
        });
        if (!estimated) return false;
        box_mean(rough_, VarianceBlur, blur_scratch_, levels_[0].variance, context);
        return !context.stop.stop_requested();
    }

    // Of the demodulated light, if the albedo was divided out.
    void row_variance(const float* variance, std::uint32_t c, std::uint32_t y, std::uint32_t width,
                      float* to) {
        float* filled = moments_.row(0, y);
        features_.fill_row(variance, y, filled);
        for (std::uint32_t x = 0; x < width; ++x) {
            const float albedo = features_.is_demodulated() ? features_.albedo().row(c, y)[x] : 1.0f;
            to[x] += filled[x] / (albedo * albedo);
        }
    }

    bool make_level(std::uint32_t s, RunContext& context) {
        Level& level = levels_[s];
        if (s > 0) {
            halve(color_of(s - 1), level.color, context);
            halve(known_of(s - 1), level.known, context);
            halve_variance(levels_[s - 1].variance, level.variance, context);
            // A pixel that covers any known pixel is known.
            for (float& known : level.known.values()) known = known > 0.0f ? 1.0f : 0.0f;
        }
        const Planes& color = color_of(s);
        if (level.match.width() != color.width() || level.match.height() != color.height()) {
            level.match = Planes(color.width(), color.height(), 4);
        }
        return for_rows(context, color.height(), [&](std::uint32_t y) {
            for (std::uint32_t c = 0; c < 4; ++c) {
                const float* from = c < 3 ? color.row(c, y) : level.variance.row(0, y);
                float* __restrict to = level.match.row(c, y);
                const float most = c < 3 ? MostColor : MostVariance;
                for (std::uint32_t x = 0; x < color.width(); ++x) {
                    to[x] = std::min(std::max(from[x], -most), most);
                }
            }
        });
    }

    Features features_;
    Planes rough_, moments_, around_, scratch_, blur_scratch_;
    std::array<Level, MostScales> levels_;
    std::array<ColorNlMeans, MostScales> windows_;
};

}  // namespace

FilterEntry nlm_entry() {
    return {{.name = "nlm",
             .summary = "non-local means of the colour at several scales, by its variances",
             .source = "Buades 2005, Rousselle 2012",
             .bytes_per_pixel = 152,
             .parameters =
                 {{"radius", "px", "of the window, at each scale", 7, 1, 20, {}},
                  {"patch", "px", "radius of the patches that are compared", 3, 0, 5, {}},
                  {"k",
                   "standard deviations",
                   "difference at which pixels still count as similar",
                   0.5,
                   0.01,
                   10.0,
                   {}},
                  {"scales", "", "each half as large as the one before", 3, 1, MostScales, {}},
                  {"demodulate", "", "divide radiance by albedo before filtering", 0, 0, 1, {"off", "on"}}},
             .channels =
                 [](const Values& values) {
                     frame::ChannelSet channels{Channel::Radiance};
                     if (values[Demodulate] == 1.0) channels.insert(Channel::Albedo);
                     return channels;
                 },
             .reads_variances = true},
            [](std::uint32_t, std::uint32_t) -> std::unique_ptr<Filter> { return std::make_unique<Nlm>(); }};
}

}  // namespace tessera::filter
