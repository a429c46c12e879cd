#ifndef TESSERA_MEDIATOR_SHADING_BUMP_H
#define TESSERA_MEDIATOR_SHADING_BUMP_H

#include "mediator/shading/motion.h"
#include "mediator/shading/textures.h"
#include "mediator/shading/triangle_points.h"

// World-space normals and tangents of triangles, and gradients of texture coordinates on them, for tangent
// frames and bump mapping.
SHADING_BEGIN

inline vec3 vertex_normal(IN(Instance) instance, IN(Mesh) mesh, uvec3 corners, vec2 b, vec3 face) {
    if ((mesh.arrays & MeshNormals) == 0u) return face;
    const vec3 mean = mesh.normals.items[corners.x] * (1.0f - b.x - b.y) +
                      mesh.normals.items[corners.y] * b.x + mesh.normals.items[corners.z] * b.y;
    if ((mesh.arrays & MeshDeforms) == 0u) return direction_of(instance.normals * mean, face);
    const vec3 next = mesh.next_normals.items[corners.x] * (1.0f - b.x - b.y) +
                      mesh.next_normals.items[corners.y] * b.x + mesh.next_normals.items[corners.z] * b.y;
    return direction_of(instance.normals * between(mean, next, mesh.key_fraction), face);
}

// The interpolated tangent, made orthogonal to the normal; w: 1 or -1, the sign of the bitangent
// w (normal x tangent); 0: no tangent. Where the instance mirrors, so does the cross product.
inline vec4 tangent_at(IN(Instance) instance, IN(Mesh) mesh, uvec3 corners, vec2 b, vec3 normal) {
    if ((mesh.arrays & MeshTangents) == 0u) return vec4(0.0f);
    const vec4 mean = mesh.tangents.items[corners.x] * (1.0f - b.x - b.y) +
                      mesh.tangents.items[corners.y] * b.x + mesh.tangents.items[corners.z] * b.y;
    const vec3 tangent = instance.linear * vec3(mean);
    const vec3 across = direction_of(tangent - normal * dot(normal, tangent), vec3(0.0f));
    if (across == vec3(0.0f)) return vec4(0.0f);
    return vec4(across.x, across.y, across.z, mean.w < 0.0f ? -instance.handedness : instance.handedness);
}

// Edges for the surface gradient of a value given at the corners, per metre, by its differences along the two
// edges from the first corner (Mikkelsen 2010). 0 for a degenerate triangle.
struct EdgesInWorld {
    vec3 p;       // from the first corner to the second, times `scale`
    vec3 q;       // and to the third
    vec3 across;  // p x q
    float scale;  // a power of two: products of a tiny triangle's edges underflow
};

inline EdgesInWorld edges_in_world(IN(Instance) instance, IN(Triangle) t) {
    const vec3 p = instance.linear * (t.q - t.p), q = instance.linear * (t.r - t.p);
    const float scale = unit_scale(extent_of(max(abs(p), abs(q))));
    return EdgesInWorld(p * scale, q * scale, cross(p * scale, q * scale), scale);
}

inline vec3 surface_gradient(IN(EdgesInWorld) edges, float along_p, float along_q) {
    const float area2 = dot(edges.across, edges.across);
    if (!(area2 > 0.0f)) return vec3(0.0f);
    return (along_p * cross(edges.q, edges.across) + along_q * cross(edges.across, edges.p)) *
           (edges.scale / area2);
}

// Differences of texture coordinates along the two edges: x = of u, y = of v.
struct TexSteps {
    vec2 p;
    vec2 q;
};

inline TexSteps tex_steps(IN(Mesh) mesh, uint set, uvec3 corners) {
    const vec2 first = tex_coord_at(mesh, set, corners, vec2(0.0f));
    return TexSteps(tex_coord_at(mesh, set, corners, vec2(1.0f, 0.0f)) - first,
                    tex_coord_at(mesh, set, corners, vec2(0.0f, 1.0f)) - first);
}

inline vec3 gradient_of_u(IN(EdgesInWorld) edges, IN(Mesh) mesh, uint set, uvec3 corners) {
    const TexSteps steps = tex_steps(mesh, set, corners);
    return surface_gradient(edges, steps.p.x, steps.q.x);
}

// Direction of growing u at constant v; w: the sign of the bitangent, which is opposite to v (which grows
// down the picture).
inline vec4 along_u(IN(EdgesInWorld) edges, IN(Mesh) mesh, uint set, uvec3 corners) {
    const TexSteps steps = tex_steps(mesh, set, corners);
    const float turn = steps.p.x * steps.q.y - steps.q.x * steps.p.y;
    const float side = turn < 0.0f ? -1.0f : 1.0f;
    const vec3 along = (edges.p * steps.q.y - edges.q * steps.p.y) * side;
    return vec4(along.x, along.y, along.z, -side);
}

// Slope of a height map along u and v, by central differences over the width of a texel. Differences are
// taken first, so that flat areas have slope 0 without rounding noise.
inline vec2 height_slope(IN(Scene) scene, IN(Texture) map, vec2 uv) {
    const vec2 size = vec2(float(map.width), float(map.height));
    vec2 rise = vec2(0.0f);
    NO_UNROLL
    for (uint i = 0u; i < 4u; ++i) {
        const float side = (i & 1u) == 0u ? 0.5f : -0.5f;
        const vec2 step = i < 2u ? vec2(side / size.x, 0.0f) : vec2(0.0f, side / size.y);
        const float height = lookup(scene, map, uv + step).x * (2.0f * side);
        rise += i < 2u ? vec2(height, 0.0f) : vec2(0.0f, height);
    }
    return rise * size;
}

// As a gradient along the surface.
inline vec3 height_gradient(IN(Scene) scene, IN(TextureUse) use, IN(EdgesInWorld) edges, IN(Mesh) mesh,
                            uvec3 corners, vec2 b) {
    const vec2 uv = tex_coord_at(mesh, use.set, corners, b);
    const vec2 place = vec2(dot(use.row_u, uv), dot(use.row_v, uv)) + use.offset;
    const vec2 slope = height_slope(scene, scene.textures.items[use.texture], place);
    const TexSteps steps = tex_steps(mesh, use.set, corners);
    const vec2 p = vec2(dot(use.row_u, steps.p), dot(use.row_v, steps.p));
    const vec2 q = vec2(dot(use.row_u, steps.q), dot(use.row_v, steps.q));
    return surface_gradient(edges, dot(slope, p), dot(slope, q));
}

SHADING_END

#endif
