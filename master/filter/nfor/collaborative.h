#pragma once

#include "master/filter/nfor/regression.h"

namespace tessera::filter::nfor {

// The two bandwidths of the weights, by index.
inline constexpr std::array<float, 2> Bandwidths{0.5f, 1.0f};

// One half of the samples, whose light is regressed with weights from the other half.
struct Half {
    std::array<std::span<const float>, Colors>
        colors;               // holes filled; after r, g, b alpha and one more, or any values
    const Planes& color;      // r, g, b: compared by the patches of this half
    const Planes& variance;   // of the means of this half
    const Planes& counts;     // samples in it
    bool correlated = false;  // neighbours share noise: `variance` as in Guide
};

struct CollaborativeSettings {
    PatchSettings window{.radius = 9, .patch = 3};
    std::uint32_t stride = 2;  // of the centres of fits: 1, 2 or 4
};

// First-order fits around every stride-th pixel in both directions; each predicts its whole window, and a
// pixel gets the mean of the predictions for it with the fits' weights (collaborative filtering, Bitterli et
// al. 2016 section 5). Weights are NL-means weights exp(-max(0, D) / k^2) of the other half times this half's
// samples at q. Every second tile in both directions shares no pixel with the others, so four passes over the
// tiles sum in a fixed order.
class Collaborative {
  public:
    // One of `out` for each of the last Bandwidths gets Colors components. False: stopped.
    bool run(const Half& half, const Half& other, const Regressors& features,
             const CollaborativeSettings& settings, std::span<Planes> out, RunContext& context);

  private:
    struct Slot {
        PatchDistance distance;
        std::vector<float> distances, weights, bandwidth, window;
    };
    struct Layout;
    void run_tile(const Tile& tile, const Layout& layout, const Half& half, const Half& other,
                  const Regressors& features, Slot& slot);
    // Copies what the fits of a tile read.
    void gather(const Tile& tile, const Layout& layout, const Half& half, const Regressors& features,
                Slot& slot) const;
    // exp(-D) of every centre and tap: for eight centres that are neighbours all taps, then the next eight.
    void measure(const Tile& tile, const Layout& layout, Slot& slot) const;
    // Fits around eight centres and adds their predictions to the window's sums.
    void predict(const Tile& tile, const Layout& layout, std::size_t k, std::size_t row, std::size_t pack,
                 Slot& slot) const;
    void prepare_taps(const Layout& layout);

    PerThread<Slot> slots_;
    std::vector<Tap> taps_;
    std::size_t bandwidth_count_ = 0;
    bool correlated_ = false;
    std::array<Planes, 2> sums_;  // weight, then predictions less the pixel's own colours
};

}  // namespace tessera::filter::nfor
