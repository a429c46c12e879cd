#version 460
// Culls instances: one invocation per instance. Culling is conservative: boxes are widened by the rounding
// errors, so that the picture does not depend on it.
#extension GL_GOOGLE_include_directive : require
#include "mediator/shading/raster.h"

layout(local_size_x_id = 0) in;

// As CullStage in raster_jobs.h.
const uint CullLastVisible = 0u, CullUnoccluded = 1u, CullInFrustum = 2u, CullNone = 3u;
const uint PyramidStep = 4u;

struct Bound {
    vec3 low;
    uint vertices;
    vec3 high;
    uint layers;
};
struct Draw {
    uint vertices, instances, first_vertex, first_instance;
};
ARRAY_OF(Bound, BoundArray, 4);
ARRAY_OF(View, ViewArray, 8);
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer DrawArray {
    Draw items[];
};
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer SeenArray {
    uint items[];
};

// As struct CullJob.
layout(push_constant, scalar) uniform Arguments {
    ViewArray view;
    BoundArray bounds;
    DrawArray draws;
    SeenArray seen;
    FloatArray depths;
    RasterCell cell;
    uint x, y, width, height;
    uint count, per_call, stage, unused;
}
job;

// A box in the clip space of the cell.
struct Footprint {
    vec2 low, high;  // of x / w and y / w with their errors; valid if the box is in front of the eye
    float nearest;   // w, less its error
    bool is_in_front;  // all of it is in front of the eye
    bool is_outside;
};

Footprint footprint_of(IN(View) view, IN(Bound) bound, vec2 area_low, vec2 area_high) {
    // Corners and vertices are sums with rounding errors: at most 12 roundings on either side, each of
    // 2^-24 of the sum of the parts' sizes, three parts in a dot product.
    const float size = max(extent_of(bound.low), extent_of(bound.high)) + extent_of(view.eye);
    const float error = 64.0f * 5.9604645e-8f * size;
    const vec2 errors =
        error * ((1.0f + abs(view.image_center)) * abs(job.cell.scale) + abs(job.cell.shift));
    Footprint footprint;
    footprint.low = vec2(infinity());
    footprint.high = vec2(-infinity());
    footprint.nearest = infinity();
    footprint.is_in_front = true;
    uint left = 0u, right = 0u, above = 0u, below = 0u, behind = 0u;
    for (uint i = 0u; i < 8u; ++i) {
        const vec3 corner = vec3((i & 1u) != 0u ? bound.high.x : bound.low.x,
                                 (i & 2u) != 0u ? bound.high.y : bound.low.y,
                                 (i & 4u) != 0u ? bound.high.z : bound.low.z);
        const vec4 clip = raster_clip(view, job.cell, corner - view.eye);
        const vec2 low_margin = errors + abs(area_low) * error;
        const vec2 high_margin = errors + abs(area_high) * error;
        left += clip.x - area_low.x * clip.w < -low_margin.x ? 1u : 0u;
        above += clip.y - area_low.y * clip.w < -low_margin.y ? 1u : 0u;
        right += clip.x - area_high.x * clip.w > high_margin.x ? 1u : 0u;
        below += clip.y - area_high.y * clip.w > high_margin.y ? 1u : 0u;
        behind += clip.w < -error ? 1u : 0u;
        footprint.nearest = min(footprint.nearest, clip.w - error);
        if (clip.w > 2.0f * error) {
            const vec2 at = clip.xy / clip.w;
            const vec2 margin = (errors + abs(at) * error) / (clip.w - error);
            footprint.low = min(footprint.low, at - margin);
            footprint.high = max(footprint.high, at + margin);
        } else {
            footprint.is_in_front = false;
        }
    }
    footprint.is_outside = max(max(left, right), max(max(above, below), behind)) == 8u;
    return footprint;
}

// Whether everything drawn so far is nearer in all pixels that the footprint may touch.
bool is_occluded(IN(Footprint) footprint) {
    const float half_edge = 0.5f * float(job.cell.edge);
    const vec2 low = (footprint.low + 1.0f) * half_edge - vec2(job.x, job.y) - 1.0f;
    const vec2 high = (footprint.high + 1.0f) * half_edge - vec2(job.x, job.y) + 1.0f;
    const vec2 last = vec2(job.width - 1u, job.height - 1u);
    uvec2 from = uvec2(clamp(low, vec2(0.0f), last));
    uvec2 to = uvec2(clamp(high, vec2(0.0f), last));
    uvec2 size = uvec2(job.width, job.height);
    uint level = 0u;
    while (max(to.x - from.x, to.y - from.y) > PyramidStep) {
        level += size.x * size.y;
        size = (size + PyramidStep - 1u) / PyramidStep;
        from /= PyramidStep;
        to /= PyramidStep;
    }
    // Depth is near / w. The rasteriser interpolates it on the plane of the triangle, also for pixels just
    // outside it, since corners are snapped to a 256th of a pixel: for triangles at least half a pixel wide the
    // error is below a 64th.
    const float depth = RasterNear / footprint.nearest * 1.015625f;
    for (uint y = from.y; y <= to.y; ++y) {
        for (uint x = from.x; x <= to.x; ++x) {
            if (!(job.depths.items[level + y * size.x + x] > depth)) return false;
        }
    }
    return true;
}

bool is_drawn(IN(Bound) bound, uint index) {
    if (bound.vertices == 0u || (bound.layers & job.view.items[0].layers) == 0u) return false;
    if (job.stage == CullNone) return true;
    if (job.stage == CullLastVisible && job.seen.items[index] == 0u) return false;
    // A margin of one pixel: corners are snapped to subpixels.
    const vec2 pixel = vec2(2.0f / float(job.cell.edge));
    const vec2 low = vec2(job.x, job.y) * pixel - 1.0f - pixel;
    const vec2 high = vec2(job.x + job.width, job.y + job.height) * pixel - 1.0f + pixel;
    const Footprint footprint = footprint_of(job.view.items[0], bound, low, high);
    if (footprint.is_outside) return false;
    return job.stage != CullUnoccluded || !footprint.is_in_front || !is_occluded(footprint);
}

void main() {
    const uint index = gl_GlobalInvocationID.x;
    if (index >= job.count) return;
    const Bound bound = job.bounds.items[index];
    const bool drawn = is_drawn(bound, index);
    if (job.stage == CullUnoccluded) job.seen.items[index] = drawn ? 1u : 0u;
    const uint place = job.count - 1u - index;
    job.draws.items[place] = Draw(bound.vertices, drawn ? 1u : 0u, 0u, place % job.per_call);
}
