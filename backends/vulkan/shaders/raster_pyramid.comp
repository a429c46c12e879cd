#version 460
// One level of the depth pyramid: the farthest depth of each square of the level below.
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 0) in;

const uint PyramidStep = 4u;  // as in raster_jobs.h

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Depths {
    float items[];
};
// As struct PyramidJob.
layout(push_constant, scalar) uniform Arguments {
    Depths depths;
    uint from, to;
    uint width, height;  // of the level below
}
job;

void main() {
    const uvec2 size = (uvec2(job.width, job.height) + PyramidStep - 1u) / PyramidStep;
    if (gl_GlobalInvocationID.x >= size.x * size.y) return;
    const uvec2 at = uvec2(gl_GlobalInvocationID.x % size.x, gl_GlobalInvocationID.x / size.x);
    const uvec2 first = at * PyramidStep;
    const uvec2 end = min(first + PyramidStep, uvec2(job.width, job.height));
    float farthest = 1.0f;
    for (uint y = first.y; y < end.y; ++y) {
        for (uint x = first.x; x < end.x; ++x) {
            farthest = min(farthest, job.depths.items[job.from + y * job.width + x]);
        }
    }
    job.depths.items[job.to + at.y * size.x + at.x] = farthest;
}
