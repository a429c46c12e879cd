#pragma once

#include <embree3/rtcore.h>

#include "mediator/shading/path_sample.h"

namespace tessera::embree {

// What traces samples (mediator/shading/trace.h), compiled for scenes and views with no other features than
// its own: what the others would cost, it does not. Where several kernels may be taken, they find the same
// bits.
struct Kernel {
    std::uint32_t features;
    // Of a pixel and the index of a sample; `rays` is raised by the rays traced. Any thread.
    shading::PathSample (*trace)(const shading::Scene& scene, const shading::View& view, RTCScene top,
                                 std::uint32_t x, std::uint32_t y, std::uint64_t sample, std::uint64_t& rays);
};

// Plain: what is in most scenes. The next have that and one thing that is seldom, with what goes with it:
// Lights spheres, quads and shadow catchers; Coated layers over surfaces and anisotropy; Glass rough glass and
// glass whose colour grows with its thickness; Film iridescence; Shader CommonSurfaceShader and what Lights
// has; Moving motion; Foggy media with and without a surface. Full: all there is, for whatever mixes them.
extern const Kernel PlainKernel, LightsKernel, CoatedKernel, GlassKernel, FilmKernel, ShaderKernel,
    MovingKernel, FoggyKernel, FullKernel;

// The first of them that has all of these.
const Kernel& kernel_for(std::uint32_t features);

}  // namespace tessera::embree
