#include "tests/filter/planes_scene.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "mediator/base/random.h"

namespace tessera::filter {

namespace {

const frame::ChannelSet Channels{frame::Channel::Radiance,     frame::Channel::LowVariance,
                                 frame::Channel::HighVariance, frame::Channel::Albedo,
                                 frame::Channel::Normal,       frame::Channel::Depth,
                                 frame::Channel::ObjectIndex,  frame::Channel::Irradiance};

SyntheticSample sample_of(const std::optional<PlanesScene::Hit>& hit, float light) {
    SyntheticSample sample;
    if (!hit) {
        sample.albedo = sample.normal = {};
        sample.depth = std::numeric_limits<float>::infinity();
        sample.object = 0;
        return sample;
    }
    sample.depth = static_cast<float>(hit->depth);
    sample.object = hit->object;
    for (int c = 0; c < 3; ++c) {
        sample.normal[c] = hit->normal[c];
        sample.albedo[c] = hit->albedo;
        sample.irradiance[c] = light;
        sample.high[c] = hit->albedo * light;
    }
    return sample;
}

}  // namespace

std::optional<PlanesScene::Hit> PlanesScene::trace(const view::CameraPose& camera, std::uint32_t width,
                                                   std::uint32_t height, double x, double y) const {
    const double px = camera.left + (camera.right - camera.left) * x / width;
    const double py = camera.top + (camera.bottom - camera.top) * y / height;
    const glm::dvec3 eye = glm::dvec3(camera.world_from_camera[3]) - origin;
    const glm::dvec3 direction(camera.world_from_camera * glm::dvec4(px, py, -1.0, 0.0));  // depth 1 per unit
    const auto texture = [&](double u, double v) {
        const double checks = std::sin(3.0 * u) * std::sin(3.0 * v);
        return static_cast<float>(textured ? 0.5 + 0.3 * checks : 0.5);
    };
    Hit hit;
    const double to_board = (-board - eye.z) / direction.z;
    const glm::dvec3 on_board = eye + to_board * direction;
    if (to_board > 0.0 && std::abs(on_board.x - board_x) < board_half && std::abs(on_board.y) < board_half) {
        hit = {on_board, {0.0f, 0.0f, 1.0f}, texture(on_board.x + 7.0, on_board.y), 0.8f, 2, to_board};
        return hit;
    }
    // z = -wall + tilt x
    const double to_wall = (-wall + tilt * eye.x - eye.z) / (direction.z - tilt * direction.x);
    if (!(to_wall > 0.0)) return std::nullopt;
    const glm::dvec3 on_wall = eye + to_wall * direction;
    const glm::dvec3 normal = glm::normalize(glm::dvec3(-tilt, 0.0, 1.0));
    const float chance = on_wall.x > shadow_x ? 0.05f : 0.5f;
    return Hit{on_wall, glm::vec3(normal), texture(on_wall.x, on_wall.y), chance, 1, to_wall};
}

view::CameraPose looking_at(const PlanesScene& scene, glm::dvec3 offset, std::uint32_t width,
                            std::uint32_t height, double yaw) {
    const glm::dmat4 transform = glm::translate(glm::dmat4(1.0), scene.origin + offset);
    return view::perspective(glm::rotate(transform, yaw, glm::dvec3(0.0, 1.0, 0.0)), 0.8,
                             double(width) / height);
}

Inputs photograph(const PlanesScene& scene, const view::CameraPose& camera, const Shot& shot) {
    const auto sampler = [&](std::uint32_t x, std::uint32_t y, std::uint64_t i) {
        CounterRandom random(mix(shot.seed), mix((std::uint64_t{y} << 32 | x) ^ mix(i)));
        const double chance = random.uniform();
        const double jx = shot.jitter ? random.uniform() : 0.5, jy = shot.jitter ? random.uniform() : 0.5;
        const auto hit = scene.trace(camera, shot.width, shot.height, x + jx, y + jy);
        float light = 0.0f;
        if (hit) light = shot.noise ? (chance < hit->chance ? 1.0f : 0.0f) : hit->chance;
        return sample_of(hit, scene.strength * light);
    };
    Inputs inputs = synthetic_inputs(shot.width, shot.height, shot.n, sampler, Channels);
    inputs.camera = camera;
    inputs.path_class = view::PathClass::Diffuse;
    // The values of a film without samples.
    for (std::size_t i = 0; i < inputs.pixel_count() && shot.coverage < 1.0; ++i) {
        CounterRandom random(mix(shot.seed + 99), i);
        if (random.uniform() < shot.coverage) continue;
        inputs.counts.plane(0)[i] = 0.0f;
        inputs.object_ids[i] = 0;
        for (std::size_t channel = 0; channel < frame::ChannelCount; ++channel) {
            const bool depth = channel == static_cast<std::size_t>(frame::Channel::Depth);
            for (Planes* planes : {&inputs.means[channel], &inputs.variances[channel]}) {
                for (std::uint32_t c = 0; c < planes->components(); ++c) {
                    planes->plane(c)[i] = depth ? std::numeric_limits<float>::infinity() : 0.0f;
                }
            }
        }
    }
    return inputs;
}

Planes truth_of(const PlanesScene& scene, const view::CameraPose& camera, std::uint32_t width,
                std::uint32_t height) {
    Planes truth(width, height, 3);
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const auto hit = scene.trace(camera, width, height, x + 0.5, y + 0.5);
            const float value = hit ? scene.strength * hit->albedo * hit->chance : 0.0f;
            for (std::uint32_t c = 0; c < 3; ++c) truth.row(c, y)[x] = value;
        }
    }
    return truth;
}

}  // namespace tessera::filter
