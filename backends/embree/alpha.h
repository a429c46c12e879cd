#pragma once

#include <embree3/rtcore.h>

#include <cstdint>

#include "mediator/shading/rays.h"

namespace tessera::embree {

// What the filter has to know of the ray; handed to Embree with every ray.
struct TraceContext {
    RTCIntersectContext embree;  // first, so that Embree's pointer is ours
    const shading::Scene* scene = nullptr;
    std::uint32_t seed = 0;  // of (pixel, sample, bounce, kind of ray)
    shading::Skip skip = shading::skip_nothing();
};

// Stops or passes rays at a surface with alpha, by shading::stops_at, or that was just passed.
void alpha_filter(const RTCFilterFunctionNArguments* arguments);

}  // namespace tessera::embree
