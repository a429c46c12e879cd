#version 460
// A vertex of a triangle of an instance; each draw is one instance. Draws are in reverse order: at equal depth
// the last draw wins, and rays find the lowest instance and triangle.
#extension GL_GOOGLE_include_directive : require
#include "backends/vulkan/shaders/raster_draw.glsl"

layout(location = 0) flat out uvec2 ids;

void main() {
    const uint index = job.scene.items[0].instance_count - 1u - (job.before + uint(gl_InstanceIndex));
    const Instance instance = job.scene.items[0].instances.items[index];
    Mesh mesh = job.scene.items[0].meshes.items[instance.mesh];
    const uint triangle = mesh.triangle_count - 1u - uint(gl_VertexIndex) / 3u;
    const vec3 corner = mesh.positions.items[mesh.triangles.items[triangle][uint(gl_VertexIndex) % 3u]];
    View view = job.view.items[0];
    gl_Position = raster_clip(view, job.cell, seen_from(view.eye, instance, corner));
    ids = uvec2(index, triangle);
}
