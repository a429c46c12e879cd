#pragma once

#include <span>

#include "master/filter/svgf/accumulate.h"
#include "master/filter/svgf/atrous_wavelet.h"
#include "master/filter/svgf/atrous_wavelet_5x5.h"
#include "master/filter/svgf/reproject.h"
#include "master/filter/svgf/spatial_variance.h"

namespace tessera::filter::svgf {

enum class WaveletKernel : std::uint8_t { Size3x3, Size5x5 };

struct Settings {
    EdgeStops stops;
    bool blurs_variance = false;  // E-D7
    Accumulation accumulation;
    SurfaceTests tests;
    std::uint32_t levels = 6;  // with 5x5 taps at most MaxLevels5x5 are used
    WaveletKernel kernel = WaveletKernel::Size3x3;
    LevelOrder order = LevelOrder::BothEnds;
    float young = 4.0f;     // below this count the variance is estimated from the neighbourhood
    float feedback = 8.0f;  // up to this count the first level is fed back into the history; 0: never
};

// One signal (kind of light) in the whole filter: its current state, its state for the previous film, and the
// wavelet levels.
class Signal {
  public:
    // State that the film is written to: colour, mean luminance, variance of one sample, age = samples.
    State& now() { return now_; }
    const State& now() const { return now_; }
    void fit(std::uint32_t width, std::uint32_t height);
    // A new film starts: the current state becomes history.
    void restart();
    void forget();
    bool has_history() const { return has_before_; }

    // Reprojects the history to this picture and blends it in. False: stopped, as in the next ones.
    bool blend_history(const Guides& now, const Guides& before, const Motion& motion,
                       const Settings& settings, const Albedos& albedos, Report& report, RunContext& context);
    // Variance and all levels; afterwards filtered() is the picture. Feedback is only used with a history.
    bool filter(const Guides& guides, const Settings& settings, bool feedback, Report& report,
                RunContext& context);
    const PaddedPlanes& filtered() const { return *filtered_; }
    // a of ConvergenceBlend for filtered(), per pixel in [0, 1]. The noise of U - F, relative to that of U, is
    // 1 - 2 w + sum w^2 with the weight w of each pixel's samples in F; the last term is what the transform leaves of the
    // variance.
    void self_weights(std::span<float> weights) const;

  private:
    bool feed_back(const PaddedPlanes& first_level, float limit, RunContext& context);

    State now_, before_;
    bool known_ = false, has_before_ = false;
    Planes history_, trust_;
    SpatialVariance variance_;
    AtrousWavelet wavelet_;
    AtrousWavelet5x5 wavelet_5x5_;
    std::array<PaddedPlanes, 2> levels_;
    const PaddedPlanes* filtered_ = nullptr;
};

}  // namespace tessera::filter::svgf
