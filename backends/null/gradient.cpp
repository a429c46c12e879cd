#include "backends/null/gradient.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "mediator/base/random.h"
#include "mediator/shading/sample_values.h"

namespace tessera::null_backend {

using frame::Channel;

namespace {

std::uint64_t mixed(std::uint64_t key, std::uint64_t value) {
    return mix(key ^ mix(value + 0x9e3779b97f4a7c15ull));
}
std::uint64_t mixed(std::uint64_t key, double value) {
    return mixed(key, std::bit_cast<std::uint64_t>(value));
}
std::uint64_t mixed(std::uint64_t key, const glm::dmat4& matrix) {
    for (int i = 0; i < 16; ++i) key = mixed(key, matrix[i / 4][i % 4]);
    return key;
}

}  // namespace

std::uint64_t content_key(const backend::ShadowScene& shadow) {
    std::uint64_t key = mixed(shadow.scene().state_hash().high, shadow.scene().state_hash().low);
    for (const backend::Instance& instance : shadow.flat_scene().instances) {
        key = mixed(mixed(key, instance.geometry.value), instance.world_from_object);
    }
    for (const backend::PlacedLight& light : shadow.flat_scene().lights) {
        key = mixed(mixed(key, light.light.value), light.world_from_light);
    }
    return key;
}

std::uint64_t view_key(std::uint64_t content, const view::View& view) {
    std::uint64_t key = mixed(mixed(content, view.seed), view.camera.world_from_camera);
    for (const double edge : {view.camera.left, view.camera.right, view.camera.bottom, view.camera.top}) {
        key = mixed(key, edge);
    }
    if (!view.camera.is_pinhole()) {
        key = mixed(mixed(key, view.camera.lens_radius), view.camera.focus_distance);
        key = mixed(key, (static_cast<std::uint64_t>(view.camera.projection) << 1) |
                             static_cast<std::uint64_t>(view.camera.aperture));
    }
    return mixed(key, (std::uint64_t{view.width} << 32) | view.height);
}

Gradient gradient(const view::View& view, const backend::FlatScene& flat_scene, std::uint64_t key,
                  std::int32_t x, std::int32_t y, std::uint64_t sample) {
    Colors light = colors(view, key, x, y, sample);
    const float most = *std::max_element(light.indirect.begin(), light.indirect.end());
    if (view.clamp_indirect > 0.0f && most > view.clamp_indirect) {
        for (float& component : light.indirect) component *= view.clamp_indirect / most;
    }
    const float u = static_cast<float>(x) / static_cast<float>(view.width);
    const float v = static_cast<float>(y) / static_cast<float>(view.height);
    const auto& instances = flat_scene.instances;
    const std::uint32_t cell = static_cast<std::uint32_t>(x / 16 + y / 16 * 7) %
                               static_cast<std::uint32_t>(instances.size() + 1);  // the last one is a miss
    const bool hit = cell < instances.size() && (instances[cell].layers & view.layers) != 0;
    const float depth = hit ? 1.0f + u + v + light.noise : std::numeric_limits<float>::infinity();
    return {.direct = light.direct,
            .indirect = light.indirect,
            .albedo = {hit ? u : 0.0f, hit ? v : 0.0f, hit ? 0.5f : 0.0f},
            .normal = {0.0f, 0.0f, hit ? 1.0f : 0.0f},
            .depth = depth,
            .object = hit ? instances[cell].geometry : ObjectId{}};
}

void append_values(const Gradient& sample, frame::ChannelSet channels, std::vector<float>& values) {
    const auto add = [&](Channel channel, const std::array<float, 3>& rgb) {
        if (channels.contains(channel)) values.insert(values.end(), rgb.begin(), rgb.end());
    };
    const auto& [direct, indirect, albedo, normal, depth, object] = sample;
    const std::array<float, 3> radiance{direct[0] + indirect[0], direct[1] + indirect[1],
                                        direct[2] + indirect[2]};
    add(Channel::Radiance, radiance);
    add(Channel::LowVariance, direct);
    add(Channel::HighVariance, indirect);
    add(Channel::Albedo, albedo);
    add(Channel::Normal, normal);
    if (channels.contains(Channel::Depth)) values.push_back(depth);
    if (channels.contains(Channel::ObjectIndex)) {
        values.push_back(depth);
        values.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(object.value)));
    }
    if (channels.contains(Channel::Alpha)) values.push_back(object.value != 0 ? 1.0f : 0.0f);
    add(Channel::Headlight, albedo);
    if (channels.contains(Channel::ShadingFeature)) values.push_back(direct[1] + indirect[1]);
    add(Channel::Irradiance, direct);
    add(Channel::Color, radiance);
    add(Channel::Root,
        {shading::root_of(radiance[0]), shading::root_of(radiance[1]), shading::root_of(radiance[2])});
}

}  // namespace tessera::null_backend
