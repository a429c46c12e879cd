#pragma once

#include <embree3/rtcore.h>

#include "mediator/shading/path_sample.h"

namespace tessera::embree {

// The path tracer (mediator/shading/trace.h), compiled for scenes and views with no other features than
// these, without the cost of others. All kernels that support a scene compute the same bits.
struct Kernel {
    std::uint32_t features;
    // Traces one sample of a pixel; adds the number of rays traced to `rays`. Thread-safe.
    shading::PathSample (*trace)(const shading::Scene& scene, const shading::View& view, RTCScene top,
                                 std::uint32_t x, std::uint32_t y, std::uint64_t sample, std::uint64_t& rays);
};

// Plain: common features only. The next add one rarely used feature each. Lights: sphere and quad lights,
// shadow catchers; Coated: coat, sheen and anisotropy; Glass: panes, rough glass and absorption in glass; Film:
// iridescence; Shader: CommonSurfaceShader and the features of Lights; Moving: motion; Foggy: media with and
// without a surface. Full: all features, for scenes that combine rare ones.
extern const Kernel PlainKernel, LightsKernel, CoatedKernel, GlassKernel, FilmKernel, ShaderKernel,
    MovingKernel, FoggyKernel, FullKernel;

// The first kernel that supports all of these features.
const Kernel& kernel_for(std::uint32_t features);

}  // namespace tessera::embree
