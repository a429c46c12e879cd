#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include "master/filter/catalog.h"
#include "mediator/filter/choice.h"
#include "tests/filter/planes_scene.h"

// Helpers for tests of progressive SVGF over many frames.
namespace tessera::filter {

inline const FilterEntry& psvgf() {
    return *parse_choice("psvgf", catalog()).value().entry;
}

// A filter that persists over frames, as for a view.
class Session {
  public:
    explicit Session(const std::string& choice)
        : choice_(parse_choice("psvgf:" + choice, catalog()).value()), filter_(choice_.entry->make(0, 0)) {
        out_.wants_maps = true;
    }
    const Output& run(const Inputs& inputs) {
        report_ = filter_->run(inputs, choice_.values, out_, {arena_, {}});
        return out_;
    }
    const Output& restart(Inputs inputs, Changes changes = {}) {
        inputs.changes = changes;
        inputs.changes.film_restarted = true;
        return run(inputs);
    }
    const Planes& map(std::string_view name) const {
        for (const DebugMap& map : out_.maps) {
            if (map.name == name) return map.planes;
        }
        throw std::out_of_range("no map " + std::string(name));
    }
    float age(std::uint32_t x, std::uint32_t y) const { return map("age").row(0, y)[x]; }
    const Report& report() const { return report_; }

  private:
    Choice choice_;
    std::unique_ptr<Filter> filter_;
    tbb::task_arena arena_{2};
    Output out_;
    Report report_;
};

// Accumulation only: no wavelet, no convergence blend, no antialiasing.
inline const std::string Raw = "levels=0,blend=off,taa=off,feedback=0,";

inline constexpr std::uint32_t Width = 96, Height = 64;

inline PlanesScene wall_alone() {
    PlanesScene scene;
    scene.board_half = 0.0;
    return scene;
}

inline double mean_of(const Planes& planes) {
    double sum = 0.0;
    for (const float v : planes.values()) sum += v;
    return sum / static_cast<double>(planes.values().size());
}

inline double variance_of(const Planes& planes) {
    const double mean = mean_of(planes);
    double sum = 0.0;
    for (const float v : planes.values()) sum += (v - mean) * (v - mean);
    return sum / static_cast<double>(planes.values().size());
}

inline double largest_difference(const Planes& a, const Planes& b) {
    double most = 0.0;
    for (std::size_t i = 0; i < a.values().size(); ++i) {
        most = std::max(most, std::abs(double(a.values()[i]) - b.values()[i]));
    }
    return most;
}

}  // namespace tessera::filter
