#pragma once

// The implementation of a kernel: each kernel source defines its features (SHADING_FEATURES) and name
// (SHADING_KERNEL), then includes this file.

// Common features. Textures, normal maps, alpha and layers are tested where a material, mesh or ray is read
// anyway; mirrors and clear glass occur in every other scene; of the lights, all except sphere and quad
// lights, which rays must be intersected with. None has a measurable cost in scenes without it.
#define PLAIN_FEATURES                                                                          \
    (shading::FeatureTextures | shading::FeatureNormalMaps | shading::FeatureAlpha |            \
     shading::FeatureSpecular | shading::FeaturePunctualLights | shading::FeatureMeshLights |   \
     shading::FeatureEnvironment | shading::FeatureEnvironmentMap | shading::FeatureLightTree | \
     shading::FeatureSunDisks | shading::FeatureLayers)

#include "backends/embree/kernel.h"
#include "backends/embree/rays.h"
#include "mediator/shading/trace.h"

// Flattened by default: otherwise the compiler's inlining decisions, and with them the time (by up to 5 %),
// change with features that the scene does not use.
#ifndef KERNEL_INLINING
#define KERNEL_INLINING [[gnu::flatten]]
#endif

namespace tessera::embree {

namespace {

// A context without path log.
struct NoPathLog : Rays {};

void log_camera(const NoPathLog&, const shading::Ray&) {}
void log_hit(const NoPathLog&, const shading::Surface&, const glm::vec3&) {}
void log_miss(const NoPathLog&) {}
void log_emission(const NoPathLog&, const glm::vec3&, const glm::vec3&) {}
void log_light(const NoPathLog&, const glm::vec3&, const glm::vec3&) {}
void log_specular(const NoPathLog&, bool, const glm::vec3&) {}
void log_receiver(const NoPathLog&, const shading::Receiver&, const shading::Ray&) {}

constexpr bool has_specular_trees(const NoPathLog&) {
    return true;
}

KERNEL_INLINING shading::PathSample trace(const shading::Scene& scene, const shading::View& view,
                                          RTCScene top, std::uint32_t x, std::uint32_t y,
                                          std::uint64_t sample, std::uint64_t& rays) {
    const float time = shading::sample_time(scene.features, view, x, y, sample);
    const shading::Path path = shading::trace_sample(NoPathLog{{scene, view, top, time}}, x, y, sample);
    rays += path.rays;
    return path.found;
}

}  // namespace

}  // namespace tessera::embree
