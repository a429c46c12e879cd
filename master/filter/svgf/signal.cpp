#include "master/filter/svgf/signal.h"

#include <array>
#include <utility>

namespace tessera::filter::svgf {

namespace {

constexpr std::array<std::string_view, MaxLevels> LevelNames{
    "wavelet 0", "wavelet 1", "wavelet 2", "wavelet 3", "wavelet 4", "wavelet 5", "wavelet 6"};

void fit_state(State& state, std::uint32_t width, std::uint32_t height) {
    state.color.fit(width, height, SignalComponents);
    if (state.moments.width() != width || state.moments.height() != height) {
        state.moments = Planes(width, height, MomentCount);
    }
}

}  // namespace

void Signal::fit(std::uint32_t width, std::uint32_t height) {
    fit_state(now_, width, height);
    for (PaddedPlanes& level : levels_) level.fit(width, height, SignalComponents);
    known_ = true;
}

void Signal::restart() {
    has_before_ = known_;
    if (known_) std::swap(now_, before_);
    known_ = false;
}

void Signal::forget() {
    known_ = has_before_ = false;
}

bool Signal::blend_history(const Guides& now, const Guides& before, const Motion& motion,
                           const Settings& settings, const Albedos& albedos, Report& report,
                           RunContext& context) {
    std::array<HistoryView, HistoryCount> views;
    for (std::uint32_t c = 0; c < 3; ++c) views[c] = {before_.color.row(c, 0), before_.color.pitch()};
    for (std::uint32_t m = 0; m < MomentCount; ++m) {
        views[HistoryMoments + m] = {before_.moments.row(m, 0), before_.moments.width()};
    }
    {
        PassTimer timer(report, "reproject", 4.0 * (3 + 2 * 5 + 2 + 2 * HistoryCount));
        if (!reproject(now, before, motion, settings.tests, views, history_, context)) return false;
    }
    PassTimer timer(report, "accumulate", 4.0 * (3 * HistoryCount + 2 * MomentCount));
    return accumulate(history_, settings.accumulation, albedos, now_, trust_, context);
}

bool Signal::filter(const Guides& guides, const Settings& settings, bool feedback, Report& report,
                    RunContext& context) {
    {
        PassTimer timer(report, "variance", 4.0 * 5);
        if (!variance_.run(guides, settings.stops, settings.young, settings.blurs_variance, now_, context))
            return false;
    }
    filtered_ = &now_.color;
    const bool wide = settings.kernel == WaveletKernel::Size5x5;
    const std::uint32_t levels = wide ? std::min(settings.levels, MaxLevels5x5) : settings.levels;
    for (std::uint32_t pass = 0; pass < pass_count(levels, settings.order); ++pass) {
        const std::uint32_t level = level_of(pass, levels, settings.order);
        PaddedPlanes& to = levels_[pass % 2];
        {
            PassTimer timer(report, pass == levels ? "wavelet 0 again" : LevelNames[level],
                            AtrousWavelet::BytesPerPixel);
            if (!(wide ? wavelet_5x5_.run(guides, settings.stops, level, *filtered_, to, context)
                       : wavelet_.run(guides, settings.stops, level, *filtered_, to, context))) {
                return false;
            }
        }
        filtered_ = &to;
        if (pass == 0 && level == 0 && feedback) {
            PassTimer timer(report, "feedback", 4.0 * 7);
            if (!feed_back(to, settings.feedback, context)) return false;
        }
    }
    return true;
}

void Signal::self_weights(std::span<float> weights) const {
    const std::uint32_t width = filtered_->width();
    for (std::uint32_t y = 0; y < filtered_->height(); ++y) {
        const float *own = filtered_->row(OwnWeightComponent, y),
                    *left = filtered_->row(VarianceComponent, y);
        // Before the transform: the variance of a mean over the history, of which the film has this fraction.
        const float *variance = now_.color.row(VarianceComponent, y),
                    *fraction = now_.color.row(OwnWeightComponent, y);
        float* __restrict to = weights.data() + std::size_t{y} * width;
        for (std::uint32_t x = 0; x < width; ++x) {
            const float part = variance[x] > 0.0f ? left[x] / variance[x] : 1.0f;  // 0: no light
            const float kept = fraction[x] * part;
            to[x] = std::min(std::max(2.0f * own[x] - kept, 0.0f), 1.0f);
        }
    }
}

bool Signal::feed_back(const PaddedPlanes& first_level, float limit, RunContext& context) {
    return for_rows(context, first_level.height(), [&](std::uint32_t y) {
        const float* age = now_.moments.row(Age, y);
        for (std::uint32_t c = 0; c < 3; ++c) {
            const float* from = first_level.row(c, y);
            float* __restrict to = now_.color.row(c, y);
            for (std::uint32_t x = 0; x < first_level.width(); ++x) {
                to[x] = (age[x] >= 1.0f) & (age[x] < limit) ? from[x] : to[x];
            }
        }
    });
}

}  // namespace tessera::filter::svgf
