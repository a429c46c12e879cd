#pragma once

#include <functional>

#include "mediator/filter/filter.h"

namespace tessera::filter {

// One sample of one pixel, as put_sample takes it; values of missing channels are ignored.
struct SyntheticSample {
    std::array<float, 3> low{}, high{};  // radiance = low + high
    std::array<float, 3> albedo{1.0f, 1.0f, 1.0f}, normal{0.0f, 0.0f, 1.0f}, headlight{0.5f, 0.5f, 0.5f};
    std::array<float, 3> irradiance{};
    float depth = 1.0f, shading = 0.0f, alpha = 1.0f;
    std::uint32_t object = 1;
};
using Sampler = std::function<SyntheticSample(std::uint32_t x, std::uint32_t y, std::uint64_t sample)>;

inline constexpr frame::ChannelSet EveryChannel = frame::ChannelSet::all();

// A film of n samples in every pixel through the production code: put_sample, block stack, merge.
frame::FilmTile synthetic_film(std::uint32_t width, std::uint32_t height, std::uint64_t n,
                               frame::ChannelSet channels, const Sampler& sampler);
view::View synthetic_view(std::uint32_t width, std::uint32_t height);
// Film and view in one step.
Inputs synthetic_inputs(std::uint32_t width, std::uint32_t height, std::uint64_t n, const Sampler& sampler,
                        frame::ChannelSet channels = EveryChannel);

// "SYN-1" of the notes: albedo half checker, half low-contrast sine; a tilted third; disc shadow and diagonal
// penumbra as the probability S that a sample finds the light. Radiance = albedo x (hit or not), exact
// features.
SyntheticSample shadowed_texture(std::uint32_t width, std::uint32_t height, std::uint32_t x, std::uint32_t y,
                                 std::uint64_t sample, std::uint64_t seed = 1);
// The limit of its samples, 3 components.
Planes shadowed_texture_truth(std::uint32_t width, std::uint32_t height);

// Runs a filter of the table on two threads with these values ("name:key=value"); maps are written if
// requested.
Output run_filter(const std::string& choice, const Inputs& inputs, bool wants_maps = false);

double mean_squared_error(const Planes& a, const Planes& b);  // per pixel, summed over channels (E-L10)

}  // namespace tessera::filter
