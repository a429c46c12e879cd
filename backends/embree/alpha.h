#pragma once

#include <embree3/rtcore.h>

#include <cstdint>

namespace tessera::embree {

struct SceneTables;

// What the filter has to know of the ray; handed to Embree with every ray.
struct TraceContext {
    RTCIntersectContext embree;  // first, so that Embree's pointer is ours
    const SceneTables* tables = nullptr;
    std::uint32_t seed = 0;  // of (pixel, sample, bounce, kind of ray)
};

// Stops or passes a ray at a surface with alpha. Mask: by the cutoff. Blend: by a hash of the ray and the
// triangle, so that the answer does not depend on the order in which Embree visits triangles; on average a
// share alpha of rays stops.
void alpha_filter(const RTCFilterFunctionNArguments* arguments);

}  // namespace tessera::embree
