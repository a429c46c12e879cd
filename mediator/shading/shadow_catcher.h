#ifndef TESSERA_MEDIATOR_SHADING_SHADOW_CATCHER_H
#define TESSERA_MEDIATOR_SHADING_SHADOW_CATCHER_H

#include "mediator/shading/light_intersection.h"

// Shadow catchers: surfaces that show only the shadows on them (Lardinoije 3). Where their alpha mask passes
// rays (stops_at) they do not exist. A camera ray that hits one continues in a random direction of the
// hemisphere. If that ray leaves the scene, the background is shown as if the catcher were not there;
// otherwise the light from what it hits. So catchers show the shadows of uniform light from all directions,
// not those of single lights. Fog in front of a catcher attenuates the background as it would attenuate a
// ground there, and fog around it casts a shadow; anything behind it, including fog, is hidden. Other paths
// pass through catchers after perfect speculars, and see the background on them after any other bounce.
SHADING_BEGIN

inline bool is_shadow_catcher(IN(Scene) scene, IN(Surface) surface) {
    return (scene.features & FeatureShadowCatcher) != 0u && surface.light == ShadowCatcher;
}

// Alpha of a background behind a medium: 1 minus what is transmitted. Exactly `alpha` without a medium, so not to be
// contracted: three times a third is more than 1.
inline float seen_through(IN(Path) path, float alpha) {
    PRECISE const float passed = (path.throughput.x + path.throughput.y + path.throughput.z) * (1.0f / 3.0f);
    return 1.0f - (1.0f - alpha) * passed;
}

// A ray that misses. The background that the camera sees may differ from the environment that lights the
// scene (Lardinoije 3), or be transparent.
WITH_CONTEXT inline void leave_scene(IN(Context) context, INOUT(Path) path, IN(Ray) ray, bool is_first) {
    const vec4 shown = context.scene.environment.visible_color;
    if (is_first && context.view.transparent_background != 0u) {
        path.found.alpha = seen_through(path, 0.0f);
        return;
    }
    if (is_first && context.scene.environment.shows_color != 0u) {
        path.found.alpha = seen_through(path, shown.w);
        add_light(path.found, context.view, path.throughput * vec3(shown) * shown.w, path.class_info);
        return;
    }
    add_shader_environment(context, path, ray);
    add_sky(context, path, ray);
    add_sun_disks(context, path, ray);
}

// Ends a camera ray that hit a catcher and then left the scene: shows the background, attenuated by the media
// on both segments.
WITH_CONTEXT inline void show_background(IN(Context) context, INOUT(Path) path, IN(Ray) camera_ray) {
    path.bsdf_pdf = 0.0f;
    path.class_info = direct_class_info();
    path.found.alpha = 0.0f;
    path.found.depth = infinity();
    path.found.object = 0u;
    leave_scene(context, path, camera_ray, true);
}

// The next ray of a camera ray that hit a catcher.
inline Ray leave_catcher(INOUT(Path) path, IN(Surface) surface) {
    const vec3 up = sample_cosine_hemisphere(first_pair(set_at(path, ScatterSet)));
    path.class_info.scatter_count += 1u;
    path.vertex += 1u;
    return leaving(surface, unit_vector(frame_around(surface.geometric_normal) * up));
}

// Any other path that hits a catcher; false: it ends here.
WITH_CONTEXT inline bool pass_catcher(IN(Context) context, INOUT(Path) path, INOUT(Ray) ray,
                                      IN(Surface) surface) {
    if (path.bsdf_pdf > 0.0f) {
        const bool has_color = context.scene.environment.shows_color != 0u;
        const vec3 light = has_color ? vec3(context.scene.environment.visible_color)
                                     : sky_at(context.scene, ray.direction).radiance;
        add_light(path.found, context.view, path.throughput * light, path.class_info);
        return false;
    }
    ray = leaving(surface, ray.direction);
    return true;
}

SHADING_END

#endif
