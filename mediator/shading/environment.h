#ifndef TESSERA_MEDIATOR_SHADING_ENVIRONMENT_H
#define TESSERA_MEDIATOR_SHADING_ENVIRONMENT_H

#include "mediator/shading/sampling.h"
#include "mediator/shading/sums.h"
#include "mediator/shading/textures.h"

// Light from infinitely far: sampled in proportion to the map's brightness (per texel, with its neighbours,
// so that whatever bilinear filtering shows can be sampled), or uniformly without a map.
SHADING_BEGIN

inline bool has_map(IN(Scene) scene) {
    return (scene.features & FeatureEnvironmentMap) != 0u;
}

// Sine of the angle to the poles, y and -y, from what does not cancel beside them.
inline float sine_from_pole(vec3 direction) {
    return sqrt(direction.x * direction.x + direction.z * direction.z);
}

// Where a direction is in a map that is turned by `rotation`, in [0, 1].
inline vec2 direction_place(vec3 direction, float rotation) {
    const float u = 0.5f + (arc_tangent(direction.x, -direction.z) + rotation) * (0.5f * InversePi);
    return vec2(u - floor(u), arc_tangent(sine_from_pole(direction), direction.y) * InversePi);
}

struct Sky {
    vec3 radiance;
    float pdf;  // of sample_sky, per solid angle
};

inline Sky sky_at(IN(Scene) scene, vec3 direction) {
    Sky sky = Sky(scene.environment.color, 1.0f / (4.0f * Pi));
    if (!has_map(scene)) return sky;
    const vec2 uv = direction_place(direction, scene.environment.rotation);
    sky.radiance += scene.environment.strength * vec3(lookup(scene, scene.environment.map, uv));
    const uint width = scene.environment.map.width;
    const uint height = scene.environment.map.height;
    const uint x = min(uint(uv.x * float(width)), width - 1u);
    const uint y = min(uint(uv.y * float(height)), height - 1u);
    const float row = probability_of(scene.sums, scene.environment.row_sums, y);
    const float column = probability_of(scene.sums, scene.environment.column_sums + y * width, x);
    const float sine_theta = sine_from_pole(direction);
    const float per_texel = row * column * float(width) * float(height);
    sky.pdf = sine_theta > 0.0f ? per_texel / (2.0f * Pi * Pi * sine_theta) : 0.0f;
    return sky;
}

inline vec3 sample_sky(IN(Scene) scene, vec2 u) {
    if (!has_map(scene)) return sample_sphere(u);
    const uint width = scene.environment.map.width;
    const uint height = scene.environment.map.height;
    const Choice row = choose(scene.sums, scene.environment.row_sums, height, u.y);
    const Choice column = choose(scene.sums, scene.environment.column_sums + row.index * width, width, u.x);
    const float theta = Pi * (float(row.index) + row.rest) / float(height);
    const float phi =
        2.0f * Pi * ((float(column.index) + column.rest) / float(width) - 0.5f) - scene.environment.rotation;
    return vec3(sine(theta) * sine(phi), cosine(theta), -sine(theta) * cosine(phi));
}

SHADING_END

#endif
