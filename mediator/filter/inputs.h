#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mediator/filter/planes.h"
#include "mediator/frame/design_effect.h"
#include "mediator/frame/film_tile.h"
#include "mediator/view/view.h"

namespace tessera::filter {

// What changed since the previous run, for temporal filters. Nothing if the same film continues (same view revision,
// same scene version).
struct Changes {
    bool film_restarted = false;       // the film is a new one
    bool lights_or_materials = false;  // radiance may differ anywhere
    bool geometry = false;             // surfaces may have moved; object ids show where
};

// The assembled frame of one view as a filter reads it: means, variances of the means and sample counts, all
// of one size. Channels that the film lacks are empty. Everything is finite but Depth, which is +inf at
// misses.
struct Inputs {
    std::uint32_t width = 0, height = 0;
    Planes counts;                                      // 1 component: accepted samples n; 0 = hole
    std::array<Planes, frame::ChannelCount> means;      // n = 0: 0 (Depth +inf)
    std::array<Planes, frame::ChannelCount> variances;  // of the mean, of Moments channels: M2 / (n (n - 1))
                                                        // times design_effect (frame/design_effect.h);
                                                        // 0 where n < 2: unknown there, not small
    std::array<Planes, 2>
        halves;  // radiance of the first half of the samples and of the others, with FirstHalf
    std::array<Planes, 2> half_counts;      // samples in each
    std::vector<std::uint32_t> object_ids;  // with ObjectIndex; 0 = miss
    view::CameraPose camera;                // of the whole picture
    view::PathClass path_class = view::PathClass::Indirect;
    Changes changes;
    frame::DesignEffect design_effect;  // of the film

    bool has(frame::Channel channel) const { return !mean(channel).empty(); }
    const Planes& mean(frame::Channel channel) const { return means[static_cast<std::size_t>(channel)]; }
    const Planes& variance(frame::Channel channel) const {
        return variances[static_cast<std::size_t>(channel)];
    }
    std::size_t pixel_count() const { return std::size_t{width} * height; }

    // The picture to be filtered: r, g, b of the radiance, or of the colour where the film has no radiance,
    // and, when there is one, premultiplied alpha.
    std::uint32_t color_components() const { return has(frame::Channel::Alpha) ? 4 : 3; }
    std::span<const float> color(std::uint32_t component) const {
        if (component == 3) return mean(frame::Channel::Alpha).plane(0);
        const bool has_radiance = has(frame::Channel::Radiance);
        return mean(has_radiance ? frame::Channel::Radiance : frame::Channel::Color).plane(component);
    }
};

// Resolves a film (frame::resolve) that covers the crop window of the view into `inputs`, reusing their memory unless
// the film is larger or has other channels. `later`: a film of the same size with only some of the samples, for
// channels that are missing in `film`.
void resolve_inputs(const frame::FilmTile& film, const view::View& view, const frame::FilmTile* later,
                    Inputs& inputs);
Inputs make_inputs(const frame::FilmTile& film, const view::View& view,
                   const frame::FilmTile* later = nullptr);

}  // namespace tessera::filter
