#pragma once

#include <embree3/rtcore.h>

#include <cstdint>

#include "mediator/shading/rays.h"
#include "mediator/shading/sampler.h"
#include "mediator/shading/thin_walls.h"

namespace tessera::embree {

// Per-ray data for the filter function, passed to Embree with every ray.
struct TraceContext {
    RTCIntersectContext embree;  // first, so that Embree's pointer can be cast
    const shading::Scene* scene = nullptr;
    shading::Sampler numbers{};  // of (pixel, bounce, kind of ray), and the sample
    shading::Skip skip = shading::skip_nothing();
    shading::ThinWalls* walls = nullptr;  // that a ray to a light has met; null for other rays
};

// Embree filter function: rejects hits that the ray has already passed (Skip), that alpha lets pass or that are unlit
// (stops_at), and on the way to a light thin walls.
void alpha_filter(const RTCFilterFunctionNArguments* arguments);

}  // namespace tessera::embree
