#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

// Busy loop: keeps the device occupied for a number of iterations.
layout(local_size_x = 64) in;

layout(buffer_reference, scalar) buffer Numbers { uint at[]; };
layout(push_constant, scalar) uniform Arguments {
    Numbers numbers;
    uint turns;
};

void main() {
    uint value = numbers.at[gl_GlobalInvocationID.x];
    for (uint i = 0; i < turns; ++i) {  // xorshift: compilers cannot fold the iterations
        value ^= value << 13;
        value ^= value >> 17;
        value ^= value << 5;
    }
    numbers.at[gl_GlobalInvocationID.x] = value;
}
