#include "master/filter/psvgf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "master/filter/convergence_blend.h"
#include "master/filter/svgf/demodulate.h"
#include "master/filter/svgf/film_layers.h"
#include "master/filter/svgf/taa.h"

namespace tessera::filter {

namespace {

using frame::Channel;
using namespace svgf;

enum Parameters : std::size_t {
    Rest,
    Mode,
    PairDeviation,
    BlurVariance,
    SigmaL,
    SigmaLHistory,
    SigmaLYoung,
    EpsL,
    SigmaN,
    SigmaD,
    EpsD,
    Steep,
    Levels,
    Order,
    Kernel,
    R0,
    LightHistory,
    LightTest,
    Young,
    Feedback,
    Taa,
    TaaRatio,
    ConvergenceSwitch,
};
constexpr double Filtered = 1.0, On = 0.0, ByAge = 0.0, Smaller = 2.0, Blurred = 1.0;
constexpr float NegligibleWeight = 1e-3f;  // of the history in the picture: below it the history is dropped

const frame::ChannelSet Needed{Channel::Radiance,   Channel::LowVariance, Channel::HighVariance,
                               Channel::Irradiance, Channel::Albedo,      Channel::Normal,
                               Channel::Depth,      Channel::ObjectIndex};

bool has_all(const Inputs& inputs) {
    for (const Channel channel :
         {Channel::Radiance, Channel::Irradiance, Channel::Albedo, Channel::Normal, Channel::Depth}) {
        if (!inputs.has(channel)) return false;
    }
    return inputs.object_ids.size() == inputs.pixel_count();
}

class Psvgf final : public Filter {
  public:
    Report run(const Inputs& inputs, const Values& values, Output& out, RunContext context) override {
        Report report;
        report.stopped = !run(inputs, values, out, context, report);
        return report;
    }

    void reset() override {
        for (Signal& signal : signals_) signal.forget();
        layers_.forget();
        known_ = has_before_ = false;
        pending_ = changes_ = {};
    }

  private:
    bool run(const Inputs& inputs, const Values& values, Output& out, RunContext& context, Report& report) {
        if (inputs.width != width_ || inputs.height != height_) reset();
        width_ = inputs.width;
        height_ = inputs.height;
        const bool rest_filtered = values[Rest] == Filtered;
        const Coverage coverage = coverage_of(inputs);
        shape(out.picture, inputs, inputs.color_components());
        out.maps.clear();
        if (!has_all(inputs)) {
            report.notes.push_back("channels that psvgf needs are missing: the picture is unfiltered");
            reset();
            copy_colors(inputs, out.picture);
            return true;
        }
        merge(inputs.changes, pending_);
        if (coverage.samples == 0.0) {
            report.notes.push_back("no samples yet: the previous picture is shown");
            copy_colors(inputs, out.picture);
            if (known_ && shown_.components() == out.picture.components()) out.picture = shown_;
            return true;
        }
        if (pending_.film_restarted) begin_film();
        if (!rest_filtered) signals_[1].forget();
        Settings settings = settings_of(values);
        known_ = false;  // until the run is complete: a stopped run leaves no valid state

        const auto signals = std::span(signals_).first(rest_filtered ? 2 : 1);
        for (Signal& signal : signals) signal.fit(inputs.width, inputs.height);
        if (!layers_.read(inputs, coverage.least == 0.0f, signals, now_, report, context)) return false;

        const float kept = std::exp(coverage.least * std::log1p(-settings.accumulation.r0));
        const bool history = has_before_ && kept > NegligibleWeight;
        if (history) {
            PassTimer timer(report, "motion", 4.0 * 4);
            if (!find_motion(now_, before_, motion_, context)) return false;
            motion_.still = motion_.identity && !changes_.lights_or_materials && !changes_.geometry &&
                            layers_.has_history();
        }
        if (history && !blend_histories(signals, settings, report, context)) return false;
        adapt(values, history, settings);
        const bool feedback = history && settings.feedback > 0.0f && mean_age() >= 1.0;
        for (Signal& signal : signals) {
            if (!signal.filter(now_, settings, feedback, report, context)) return false;
        }
        if (!layers_.compose(inputs, signals, out.picture, report, context)) return false;
        if (values[ConvergenceSwitch] == On) {
            PassTimer timer(report, "convergence blend",
                            ConvergenceBlend::bytes_per_pixel(out.picture.components()));
            if (!blend_with_samples(inputs, signals, out.picture, report, context)) return false;
        }
        const bool shown_fits = shown_before_.pixel_count() == inputs.pixel_count() &&
                                shown_before_.components() == out.picture.components();
        if (history && values[Taa] == On && shown_fits) {
            PassTimer timer(report, "antialias", 4.0 * (4 * out.picture.components() + 2 * 4 + 5));
            if (!smooth_edges(inputs, static_cast<float>(values[TaaRatio]), out.picture, context))
                return false;
        }
        PassTimer timer(report, "keep", 8.0 * (out.picture.components() + 6));
        shape(shown_, inputs, out.picture.components());
        std::ranges::copy(out.picture.values(), shown_.values().begin());
        layers_.keep(inputs);
        if (out.wants_maps) write_maps(inputs, out);
        known_ = true;
        return true;
    }

    bool blend_with_samples(const Inputs& inputs, std::span<Signal> signals, Planes& picture, Report& report,
                            RunContext& context) {
        if (!knows_diffuse(inputs)) {
            return convergence_blend_.apply(inputs, Channel::Radiance, self_weights(signals), picture,
                                            context);
        }
        if (signals.size() == 1) {
            return convergence_blend_.apply(inputs, Channel::HighVariance, self_weights(signals), picture,
                                            context);
        }
        // Each part for itself: in the noise of both, errors of one are not seen.
        const Planes& rest = inputs.mean(Channel::LowVariance);
        if (!layers_.compose(inputs, signals.first(1), rest, picture, report, context) ||
            !convergence_blend_.apply(inputs, Channel::HighVariance, self_weights(signals.first(1)), picture,
                                      context))
            return false;
        shape(other_part_, inputs, picture.components());
        copy_colors(inputs, other_part_);
        add_difference(signals[1].filtered(), rest, other_part_);
        if (!convergence_blend_.apply(inputs, Channel::LowVariance, self_weights(signals.last(1)),
                                      other_part_, context))
            return false;
        for (std::uint32_t c = 0; c < 3; ++c) {
            const auto color = inputs.color(c);
            const auto other = other_part_.plane(c);
            const auto to = picture.plane(c);
            for (std::size_t i = 0; i < to.size(); ++i) to[i] += other[i] - color[i];
        }
        return true;
    }

    // `to` += a - b
    static void add_difference(const PaddedPlanes& a, const Planes& b, Planes& to) {
        for (std::uint32_t c = 0; c < 3; ++c) {
            for (std::uint32_t y = 0; y < to.height(); ++y) {
                const float *from = a.row(c, y), *less = b.row(c, y);
                float* row = to.row(c, y);
                for (std::uint32_t x = 0; x < to.width(); ++x) row[x] += from[x] - less[x];
            }
        }
    }

    bool blend_histories(std::span<Signal> signals, const Settings& settings, Report& report,
                         RunContext& context) {
        for (Signal& signal : signals) {
            const bool weighs = motion_.still && &signal == signals.data();
            if (signal.has_history() &&
                !signal.blend_history(now_, before_, motion_, settings,
                                      weighs ? layers_.albedos() : Albedos{}, report, context)) {
                return false;
            }
        }
        return !motion_.still || layers_.blend_history(signals[0].now(), report, context);
    }

    Settings settings_of(const Values& values) const {
        const auto value = [&](Parameters parameter) { return static_cast<float>(values[parameter]); };
        Settings settings;
        settings.stops = {.sigma_n = value(SigmaN),
                          .sigma_d = value(SigmaD),
                          .eps_d = value(EpsD),
                          .steep = value(Steep),
                          .sigma_l = value(SigmaL),
                          .eps_l = value(EpsL),
                          .deviation = static_cast<Deviation>(static_cast<int>(values[Mode])),
                          .pair = values[PairDeviation] == Smaller ? Pair::Smaller : Pair::Larger};
        settings.accumulation.r0 = value(R0);
        settings.accumulation.age_scale = changes_.lights_or_materials ? value(LightHistory) : 1.0f;
        settings.accumulation.z0 =
            changes_.lights_or_materials || changes_.geometry ? value(LightTest) : 0.0f;
        settings.levels = static_cast<std::uint32_t>(values[Levels]);
        settings.order = static_cast<LevelOrder>(static_cast<int>(values[Order]));
        settings.kernel = static_cast<WaveletKernel>(static_cast<int>(values[Kernel]));
        settings.blurs_variance = values[BlurVariance] == Blurred;
        settings.young = value(Young);
        settings.feedback = value(Feedback);
        return settings;
    }

    // To how much is known of the variances, see Pair.
    void adapt(const Values& values, bool history, Settings& settings) {
        if (is_young(settings.young)) {
            if (values[PairDeviation] == ByAge) settings.stops.pair = Pair::Smaller;
            if (values[BlurVariance] == ByAge) settings.blurs_variance = true;
            settings.stops.sigma_l = static_cast<float>(values[SigmaLYoung]);
        } else {
            // As the best width of a kernel falls with the samples of a density. Narrower than the least, it would leave noise
            // in converging pictures.
            constexpr double Least = 0.63;
            const double alone =
                values[SigmaL] * std::max(Least, std::pow(4.0 / std::max(mean_age(), 4.0), 0.2));
            const double own = history ? mean_own_weight() : 1.0;
            settings.stops.sigma_l = static_cast<float>(own * alone + (1.0 - own) * values[SigmaLHistory]);
        }
    }

    static void copy_colors(const Inputs& inputs, Planes& picture) {
        for (std::uint32_t c = 0; c < picture.components(); ++c) {
            std::ranges::copy(inputs.color(c), picture.plane(c).begin());
        }
    }

    // A film without samples is ignored, but its changes are kept.
    static void merge(const Changes& from, Changes& to) {
        to.film_restarted |= from.film_restarted;
        to.lights_or_materials |= from.lights_or_materials;
        to.geometry |= from.geometry;
    }

    void begin_film() {
        if (known_) {
            for (Signal& signal : signals_) signal.restart();
            layers_.restart();
            std::swap(now_, before_);
            std::swap(shown_, shown_before_);
            has_before_ = true;
            changes_ = {};
        }
        merge(std::exchange(pending_, {}), changes_);
    }

    // In lanes, so that it is vectorised.
    static double row_sum(const float* row, std::uint32_t count) {
        std::array<float, 8> lanes{};
        std::uint32_t x = 0;
        for (; x + 8 <= count; x += 8) {
            for (std::uint32_t k = 0; k < 8; ++k) lanes[k] += row[x + k];
        }
        return std::accumulate(row + x, row + count, std::accumulate(lanes.begin(), lanes.end(), 0.0));
    }

    double mean_age() const {
        double sum = 0.0;
        for (std::uint32_t y = 0; y < height_; ++y)
            sum += row_sum(signals_[0].now().moments.row(Age, y), width_);
        return sum / (double(width_) * height_);
    }

    // Of the film in the history, after the blend.
    double mean_own_weight() const {
        double sum = 0.0;
        for (std::uint32_t y = 0; y < height_; ++y)
            sum += row_sum(signals_[0].now().color.row(OwnWeightComponent, y), width_);
        return sum / (double(width_) * height_);
    }

    // Whether most pixels are.
    bool is_young(float limit) const {
        const auto ages = signals_[0].now().moments.plane(Age);
        const auto young = std::ranges::count_if(ages, [limit](float age) { return age < limit; });
        return 2 * young > static_cast<std::ptrdiff_t>(ages.size());
    }

    // Of the picture: the least of the signals', so that noise is not underestimated.
    std::span<const float> self_weights(std::span<const Signal> signals) {
        for (std::size_t i = 0; i < signals.size(); ++i) {
            self_weights_[i].resize(std::size_t{width_} * height_);
            signals[i].self_weights(self_weights_[i]);
        }
        std::vector<float>& least = self_weights_[0];
        if (signals.size() > 1) {
            std::ranges::transform(least, self_weights_[1], least.begin(),
                                   [](float a, float b) { return std::min(a, b); });
        }
        return least;
    }

    bool smooth_edges(const Inputs& inputs, float ratio, Planes& picture, RunContext& context) {
        shape(newness_, inputs, 1);
        const Planes& moments = signals_[0].now().moments;
        for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
            const float age = moments.plane(Age)[i];
            newness_.plane(0)[i] = age > 0.0f ? inputs.counts.plane(0)[i] / age : 1.0f;
        }
        if (!antialiasing_.run(picture, shown_before_, now_, motion_, newness_, ratio, smoothed_, context))
            return false;
        std::ranges::copy(smoothed_.values(), picture.values().begin());
        return true;
    }

    void write_maps(const Inputs& inputs, Output& out) {
        Planes irradiance(inputs.width, inputs.height, 3), deviation(inputs.width, inputs.height, 1),
            age(inputs.width, inputs.height, 1);
        State& state = signals_[0].now();
        for (std::uint32_t y = 0; y < inputs.height; ++y) {
            for (std::uint32_t c = 0; c < 3; ++c) {
                std::copy_n(signals_[0].filtered().row(c, y), inputs.width, irradiance.row(c, y));
            }
            for (std::uint32_t x = 0; x < inputs.width; ++x) {
                deviation.row(0, y)[x] = std::sqrt(state.color.row(3, y)[x]);
            }
            std::copy_n(state.moments.row(Age, y), inputs.width, age.row(0, y));
        }
        out.maps.push_back({"irradiance", std::move(irradiance)});
        out.maps.push_back({"deviation", std::move(deviation)});
        out.maps.push_back({"age", std::move(age)});
    }

    std::uint32_t width_ = 0, height_ = 0;
    std::array<Signal, 2> signals_;  // irradiance; the rest, if it is filtered
    Guides now_, before_;
    bool known_ = false, has_before_ = false;  // whether now_ and before_ are valid, with all their data
    Changes pending_, changes_;                // since the last run with samples; since before_
    Motion motion_;
    FilmLayers layers_;
    ConvergenceBlend convergence_blend_;
    std::array<std::vector<float>, 2> self_weights_;
    Antialiasing antialiasing_;
    Planes shown_, shown_before_, smoothed_, newness_, other_part_;
};

Parameter number(std::string_view name, std::string_view unit, std::string_view help, double usual,
                 double least, double most) {
    return {name, unit, help, usual, least, most, {}};
}
// The first value is the usual one.
Parameter choice(std::string_view name, std::string_view help, std::vector<std::string_view> values) {
    return {name, "", help, 0.0, 0.0, double(values.size() - 1), std::move(values)};
}

// In the order of Parameters.
std::vector<Parameter> psvgf_parameters() {
    return {
        choice("rest", "light of all other lobes", {"unfiltered", "filtered"}),
        choice("mode",
               "what a luminance difference is measured in (E-D11): deviation of the mean, variance, "
               "deviation of "
               "one sample",
               {"age", "dundr", "svgf"}),
        choice("pair",
               "of two pixels, the one whose deviation a luminance difference is measured in (E-D11: "
               "smaller); by_age: "
               "smaller below min_history",
               {"by_age", "larger", "smaller"}),
        choice("blur", "blur of the variance with 3x3 pixels (E-D7: on); by_age: below min_history",
               {"by_age", "on", "off"}),
        number("sigma_l", "deviations",
               "luminance difference that stops the filter with 4 samples (E-D11; Dundr: 4); falls with "
               "their fifth root to 0.63 of it",
               1.75, 0.0, 1e3),
        number("history_sigma_l", "deviations", "the same of history alone", 0.95, 0.0, 1e3),
        number("young_sigma_l", "deviations", "the same below min_history", 4.0, 0.0, 1e3),
        number("eps_l", "of the luminance", "luminance difference that is always ignored (E-D11)", 0.01, 0.0,
               10.0),
        number("sigma_n", "", "exponent of the normals' cosine (E-D9)", 64.0, 0.0, 1e4),
        number("sigma_d", "slopes", "depth difference on one surface (E-D10)", 1.0, 0.0, 1e3),
        number("eps_d", "of the depth", "depth difference that is always ignored (E-D10)", 0.005, 0.0, 1.0),
        number("steep", "of the depth per px", "slope above which depth is ignored", 0.2, 0.0, 1e6),
        number("levels", "", "levels of the wavelet transform", 6, 0, MaxLevels),
        choice("order",
               "order of the levels; both_ends: 0 5 4 3 2 1 0, first_then_coarse (Dundr): 0 5 4 3 2 1",
               {"both_ends", "first_then_coarse", "fine", "coarse"}),
        choice("kernel", "taps of a level; 5x5 uses at most 6 levels", {"3x3", "5x5"}),
        number("r0", "", "minimum weight of a new sample in the history (E-D3)", 0.1, 0.0, 0.999),
        number("light_history", "", "fraction of its age that history keeps when light changes", 0.25, 0.0,
               1.0),
        number("light_test", "deviations",
               "difference above which history is distrusted after an edit; 0: never", 3.0, 0.0, 1e3),
        number("min_history", "samples", "below this count the variance is estimated from the neighbourhood",
               4.0, 2.0, 64.0),
        number("feedback", "samples",
               "up to this count the first level is fed back into the history; 0: never", 8.0, 0.0, 1e6),
        choice("taa", "temporal antialiasing where history is used", {"on", "off"}),
        number("taa_ratio", "", "minimum weight of the new picture in it (E-D14)", 0.1, 0.0, 1.0),
        choice("blend", "blend back to the samples as they converge", {"on", "off"})};
}

}  // namespace

FilterEntry psvgf_entry() {
    return {
        {.name = "psvgf",
         .summary = "progressive SVGF: history and edge-stopping wavelets on the diffuse irradiance",
         .source = "Dundr 2",
         .bytes_per_pixel = 694,
         .parameters = psvgf_parameters(),
         .channels = [](const Values&) { return Needed; },
         .consistent = true,
         .reads_variances = true,
         .temporal = true,
         .path_class = view::PathClass::Diffuse},
        [](std::uint32_t, std::uint32_t) -> std::unique_ptr<Filter> { return std::make_unique<Psvgf>(); }};
}

}  // namespace tessera::filter
