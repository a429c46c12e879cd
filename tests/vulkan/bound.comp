#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_samplerless_texture_functions : require

// Reads the same numbers through all three kinds of access.
layout(local_size_x = 64) in;

layout(set = 0, binding = 0) uniform utextureBuffer texels;
layout(set = 0, binding = 3, scalar) buffer Storage { uint at[]; } storage;
layout(buffer_reference, scalar) buffer Numbers { uvec4 at[]; };
layout(push_constant, scalar) uniform Arguments {
    Numbers to;
    uint count;
};

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i < count) to.at[i] = texelFetch(texels, int(i)) + uvec4(storage.at[i]);
}
