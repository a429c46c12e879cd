#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mediator/backend/shadow_scene.h"
#include "mediator/frame/channels.h"
#include "mediator/view/view.h"

namespace tessera::null_backend {

// One sample of one pixel, as a path tracer would find it.
struct Gradient {
    std::array<float, 3> direct, indirect, albedo, normal;
    float depth;
    ObjectId object;
};

// Numbers for everything in the scene, and then in the view, that a picture may depend on.
std::uint64_t content_key(const backend::ShadowScene& shadow);
std::uint64_t view_key(std::uint64_t content, const view::View& view);

// A pure function of its arguments. `key` is the view's.
Gradient gradient(const view::View& view, const backend::Lowered& lowered, std::uint64_t key, std::int32_t x,
                  std::int32_t y, std::uint64_t sample);

// In the order in which frame::put_sample wants them; `index` is the sample's.
void append_values(const Gradient& sample, std::uint64_t index, frame::ChannelSet channels,
                   std::vector<float>& values);

}  // namespace tessera::null_backend
