#version 460
#extension GL_GOOGLE_include_directive : require

#include "tests/shading/cases.h"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint Function = 0u;  // a kernel for each: a software device runs all branches

ARRAY_OF(Inputs, InputArray, 4);
layout(buffer_reference, scalar) writeonly buffer OutputArray { Outputs items[]; };

layout(push_constant, scalar) uniform Arguments {
    InputArray inputs;
    OutputArray outputs;
    uint count;
};

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i < count) outputs.items[i] = evaluate(Function, inputs.items[i]);
}
