#pragma once

#include <span>

#include "master/filter/svgf/hole_fill.h"
#include "master/filter/svgf/signal.h"

namespace tessera::filter::svgf {

struct Coverage {
    double samples = 0.0;  // in the whole film
    float least = 0.0f;    // in a pixel
};
Coverage coverage_of(const Inputs& inputs);

// Splits the film into signals and the layers that are multiplied with or added to them, and composes them
// again. The first signal is the irradiance, the optional second one the rest.
class FilmLayers {
  public:
    // Fills the signals and the guides of the film, holes included. False: stopped, as below.
    bool read(const Inputs& inputs, bool holes, std::span<Signal> signals, Guides& guides, Report& report,
              RunContext& context);

    // For films of a still picture, whose layers have a history like the signals: keep() after a film, restart() before
    // the next one.
    void keep(const Inputs& inputs);
    void restart();
    void forget() { known_ = has_before_ = false; }
    // Of the film that was read.
    bool has_history() const {
        return has_before_ && (alpha_ == nullptr || alpha_before_.pixel_count() == alpha_->pixel_count());
    }
    Albedos albedos() const { return {albedo_, &albedo_before_}; }
    // Layers become their mean with the history, in which the film has the weight of own samples of `light`. False: stopped.
    bool blend_history(const State& light, Report& report, RunContext& context);

    // picture = rest + albedo x irradiance.
    bool compose(const Inputs& inputs, std::span<const Signal> signals, Planes& picture, Report& report,
                 RunContext& context) const;
    // With one signal this is the rest.
    bool compose(const Inputs& inputs, std::span<const Signal> signals, const Planes& unfiltered,
                 Planes& picture, Report& report, RunContext& context) const;

  private:
    bool fill_holes(const Inputs& inputs, std::span<Signal> signals, Guides& guides, RunContext& context);

    HoleFill hole_fill_;
    std::vector<PlaneView> filled_;
    Planes own_albedo_, own_rest_, own_alpha_;  // copies whose holes are filled, or with the history
    Planes albedo_before_, rest_before_, alpha_before_;
    bool known_ = false, has_before_ = false;
    const Planes *albedo_ = nullptr, *rest_ = nullptr, *alpha_ = nullptr;
};

}  // namespace tessera::filter::svgf
