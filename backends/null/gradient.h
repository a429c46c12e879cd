#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mediator/backend/shadow_scene.h"
#include "mediator/base/random.h"
#include "mediator/frame/channels.h"
#include "mediator/view/view.h"

namespace tessera::null_backend {

// The light of one sample of one pixel.
struct Colors {
    std::array<float, 3> direct, indirect;
    float noise;
};

// One sample of one pixel, with all values that a path tracer returns.
struct Gradient {
    std::array<float, 3> direct, indirect, albedo, normal;
    float depth;
    ObjectId object;
};

// Hashes of everything in the scene, and then in the view, that a picture may depend on.
std::uint64_t content_key(const backend::ShadowScene& shadow);
std::uint64_t view_key(std::uint64_t content, const view::View& view);

// Pure functions of their arguments. `key` is the view's. Colors are those of the gradient.
inline Colors colors(const view::View& view, std::uint64_t key, std::int32_t x, std::int32_t y,
                     std::uint64_t sample) {
    const std::uint64_t place = (std::uint64_t(std::uint32_t(y)) << 32) | std::uint32_t(x);
    CounterRandom random(key, mix(place ^ mix(sample + 0x9e3779b97f4a7c15ull)));
    const float u = static_cast<float>(x) / static_cast<float>(view.width);
    const float v = static_cast<float>(y) / static_cast<float>(view.height);
    const float noise = static_cast<float>(random.uniform());
    return {.direct = {u * noise, v * noise, 0.5f * noise},
            .indirect = {0.1f * static_cast<float>(random.uniform()), 0.05f, 0.025f * noise},
            .noise = noise};
}
Gradient gradient(const view::View& view, const backend::FlatScene& flat_scene, std::uint64_t key,
                  std::int32_t x, std::int32_t y, std::uint64_t sample);

// In the order of frame::put_sample.
void append_values(const Gradient& sample, frame::ChannelSet channels, std::vector<float>& values);

}  // namespace tessera::null_backend
