#version 460
// Squares of two triangles, one for each instance, at one depth each.
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

struct Quad {
    float x, y, size, depth;
};
layout(buffer_reference, scalar) readonly buffer Quads {
    Quad items[];
};
layout(push_constant, scalar) uniform Arguments {
    Quads quads;
    uint before;
};
layout(location = 0) flat out uvec2 ids;

void main() {
    const uint instance = before + gl_InstanceIndex;
    const Quad quad = quads.items[instance];
    const uint corner = uint[6](0u, 1u, 2u, 2u, 1u, 3u)[gl_VertexIndex];
    const vec2 at = vec2(quad.x, quad.y) + quad.size * vec2(corner & 1u, corner >> 1);
    gl_Position = vec4(at, quad.depth, 1.0);
    ids = uvec2(instance, gl_VertexIndex / 3);
}
