#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

// to[i] = a[i] + b[i] + summand: one step of a chain.
layout(local_size_x = 64) in;

layout(buffer_reference, scalar) buffer Numbers { uint at[]; };
layout(push_constant, scalar) uniform Arguments {
    Numbers a, b, to;
    uint count, summand;
};

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i < count) to.at[i] = a.at[i] + b.at[i] + summand;
}
