#ifndef TESSERA_MEDIATOR_SHADING_ENVIRONMENT_H
#define TESSERA_MEDIATOR_SHADING_ENVIRONMENT_H

#include "mediator/shading/cdf.h"
#include "mediator/shading/sampling.h"
#include "mediator/shading/textures.h"

// The environment light. Of a map, what exceeds its mean luminance is sampled in proportion (MIS compensation,
// Karlik et al. 2019); BSDF samples alone find the rest, and an environment without a map.
SHADING_BEGIN

inline bool has_map(IN(Scene) scene) {
    return (scene.features & FeatureEnvironmentMap) != 0u;
}

// Sine of the angle to the poles y and -y, without cancellation near them.
inline float sine_to_pole(vec3 direction) {
    return sqrt(direction.x * direction.x + direction.z * direction.z);
}

// Texture coordinates of a direction, in [0, 1], in a map whose middle is -z, rotated by `rotation`.
inline vec2 direction_to_uv(vec3 direction, float rotation) {
    const float u = 0.5f + (arc_tangent(direction.x, -direction.z) + rotation) * (0.5f * InversePi);
    return vec2(u - floor(u), arc_tangent(sine_to_pole(direction), direction.y) * InversePi);
}

struct Sky {
    vec3 radiance;
    float pdf;  // of sample_sky, per solid angle; may be 0 where the sky is not black
};

inline Sky sky_at(IN(Scene) scene, vec3 direction) {
    Sky sky = Sky(scene.environment.color, 0.0f);
    if (!has_map(scene)) return sky;
    const vec2 uv = direction_to_uv(direction, scene.environment.rotation);
    sky.radiance += scene.environment.strength * vec3(lookup(scene, scene.environment.map, uv));
    const uint width = scene.environment.map.width;
    const uint height = scene.environment.map.height;
    const uint x = min(uint(uv.x * float(width)), width - 1u);
    const uint y = min(uint(uv.y * float(height)), height - 1u);
    const float row = probability_of(scene.cdfs, scene.environment.row_cdf, y);
    const float column = probability_of(scene.cdfs, scene.environment.column_cdf + y * width, x);
    const float sine_theta = sine_to_pole(direction);
    const float per_texel = row * column * float(width) * float(height);
    sky.pdf = sine_theta > 0.0f ? per_texel / (2.0f * Pi * Pi * sine_theta) : 0.0f;
    return sky;
}

// Needs a map.
inline vec3 sample_sky(IN(Scene) scene, vec2 u) {
    const uint width = scene.environment.map.width;
    const uint height = scene.environment.map.height;
    const Choice row = choose(scene.cdfs, scene.environment.row_cdf, height, u.y);
    const Choice column = choose(scene.cdfs, scene.environment.column_cdf + row.index * width, width, u.x);
    const float theta = Pi * (float(row.index) + row.rest) / float(height);
    const float phi =
        2.0f * Pi * ((float(column.index) + column.rest) / float(width) - 0.5f) - scene.environment.rotation;
    return vec3(sine(theta) * sine(phi), cosine(theta), -sine(theta) * cosine(phi));
}

SHADING_END

#endif
