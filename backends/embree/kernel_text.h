#pragma once

// A kernel: included by the one source that says which features it has (SHADING_FEATURES), and its name
// (SHADING_KERNEL).

// What most scenes have a part of. Textures, normal maps, alpha and layers are asked for where a material, a
// mesh or a ray is looked at in any case; mirrors and clear glass are in every other scene; and of lights all but
// those with a shape, which rays have to look for on their way. None costs what can be measured where it is not.
#define PLAIN_FEATURES                                                                          \
    (shading::FeatureTextures | shading::FeatureNormalMaps | shading::FeatureAlpha |            \
     shading::FeatureSpecular | shading::FeaturePlacedLights | shading::FeatureMeshLights |     \
     shading::FeatureEnvironment | shading::FeatureEnvironmentMap | shading::FeatureLightTree | \
     shading::FeatureSuns | shading::FeatureLayers)

#include "backends/embree/kernel.h"
#include "backends/embree/rays.h"
#include "mediator/shading/trace.h"

// In one piece, unless said otherwise: what a compiler inlines on its own changes with features that no scene
// has asked for, and so does the time, by as much as 5 %.
#ifndef KERNEL_PIECES
#define KERNEL_PIECES [[gnu::flatten]]
#endif

namespace tessera::embree {

namespace {

// Tells nothing of a path.
struct Silent : Rays {};

void tell_camera(const Silent&, const shading::Ray&) {}
void tell_hit(const Silent&, const shading::Surface&, const glm::vec3&) {}
void tell_miss(const Silent&) {}
void tell_emission(const Silent&, const glm::vec3&, const glm::vec3&) {}
void tell_light(const Silent&, const glm::vec3&, const glm::vec3&) {}
void tell_specular(const Silent&, bool, const glm::vec3&) {}

constexpr bool has_specular_trees(const Silent&) {
    return true;
}

KERNEL_PIECES shading::PathSample trace(const shading::Scene& scene, const shading::View& view, RTCScene top,
                                        std::uint32_t x, std::uint32_t y, std::uint64_t sample,
                                        std::uint64_t& rays) {
    const float time = shading::sample_time(scene.features, view, x, y, sample);
    const shading::Path path = shading::trace_sample(Silent{{scene, view, top, time}}, x, y, sample);
    rays += path.rays;
    return path.found;
}

}  // namespace

}  // namespace tessera::embree
