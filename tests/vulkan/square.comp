#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 0) in;
layout(constant_id = 1) const uint Added = 0;

layout(buffer_reference, scalar) buffer Numbers { uint at[]; };
layout(push_constant, scalar) uniform Arguments {
    Numbers numbers;
    uint count;
    uint first;
};

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i < count) numbers.at[first + i] = numbers.at[first + i] * numbers.at[first + i] + Added;
}
