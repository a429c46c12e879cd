#version 460
#extension GL_GOOGLE_include_directive : require
#include "tests/transport/brute_force.h"
#include "mediator/shading/trace.h"

layout(local_size_x = 64) in;

layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Results {
    float items[];
};
struct Sink {
    Results results;
    uint next;
};
void store_value(INOUT(Sink) sink, float value) {
    sink.results.items[sink.next] = value;
    sink.next += 1u;
}

#include "mediator/shading/sample_values.h"

ARRAY_OF(Scene, SceneArray, 8);
ARRAY_OF(View, ViewArray, 8);
layout(push_constant, scalar) uniform Arguments {
    SceneArray scene;
    ViewArray view;
    Results results;
};

// The scene's features, as in the back-end's kernels.
layout(constant_id = 0) const uint Features = 0xffffffffu;

// Sample i of a picture is the i-th of its pixels, row by row, then the next sample of each.
void main() {
    Context context = Context(scene.items[0], view.items[0], 0.0f);
    context.scene.features = Features;
    const uint i = gl_GlobalInvocationID.x;
    const uint pixels = context.view.width * context.view.height;
    const uint pixel = i % pixels;
    const Path path = trace_sample(context, pixel % context.view.width, pixel / context.view.width, i / pixels);
    Sink sink = Sink(results, i * MaxSampleValues);
    put_sample_values(sink, context.view, path.found);
}
