#ifndef TESSERA_MEDIATOR_SHADING_SHADOW_CATCHER_H
#define TESSERA_MEDIATOR_SHADING_SHADOW_CATCHER_H

#include "mediator/shading/seen_lights.h"

// Surfaces that show nothing but the shadows on them (Lardinoije 3), within their mask: where that lets rays
// through (stops_at) they are not there. A camera ray that meets one goes on in a direction by chance. Where
// that one leaves the scene, the background is seen as if nothing were there; else the light that comes from
// what it meets. So it is shadows from light of all around that are caught, none of single lights. Fog before
// the catcher dims the background as it would dim a ground there, and fog around it casts its shadow; what
// lies behind the catcher is not seen, of fog neither. For paths that come from elsewhere, catchers are not
// there after perfect speculars, and shine like the background after anything else.
SHADING_BEGIN

inline bool catches(IN(Scene) scene, IN(Surface) surface) {
    return (scene.features & FeatureShadowCatcher) != 0u && surface.light == ShadowCatcher;
}

// Alpha of a background behind a medium: 1 but for what comes through.
inline float seen_through(IN(Path) path, float alpha) {
    const float passed = (path.throughput.x + path.throughput.y + path.throughput.z) * (1.0f / 3.0f);
    return 1.0f - (1.0f - alpha) * passed;
}

// A ray that hits nothing. What the camera sees itself may be another background than what lights the scene
// (Lardinoije 3), or none.
WITH_CONTEXT inline void leave_scene(IN(Context) context, INOUT(Path) path, IN(Ray) ray, bool is_first) {
    const vec4 shown = context.scene.environment.visible_color;
    if (is_first && context.view.transparent_background != 0u) {
        path.found.alpha = seen_through(path, 0.0f);
        return;
    }
    if (is_first && context.scene.environment.shows_color != 0u) {
        path.found.alpha = seen_through(path, shown.w);
        add_light(path.found, context.view, path.throughput * vec3(shown) * shown.w, path.way);
        return;
    }
    add_own_environment(context, path, ray);
    add_sky(context, path, ray);
    add_suns(context, path, ray);
}

// What a camera ray has come to that was caught. It carries what media have left on both ways.
WITH_CONTEXT inline void show_background(IN(Context) context, INOUT(Path) path, IN(Ray) camera_ray) {
    path.bsdf_pdf = 0.0f;
    path.way = direct_way();
    path.found.alpha = 0.0f;
    path.found.depth = infinity();
    path.found.object = 0u;
    leave_scene(context, path, camera_ray, true);
}

// The camera's: it goes on from there.
inline Ray caught(INOUT(Path) path, IN(Surface) surface) {
    const vec3 up = sample_cosine_hemisphere(pair_at(path, PairBsdfDirection));
    path.way.scatterings += 1u;
    path.vertex += 1u;
    return leaving(surface, unit_vector(frame_around(surface.geometric_normal) * up));
}

// A path from elsewhere; false: it ends here.
WITH_CONTEXT inline bool pass_catcher(IN(Context) context, INOUT(Path) path, INOUT(Ray) ray,
                                      IN(Surface) surface) {
    if (path.bsdf_pdf > 0.0f) {
        const bool has_color = context.scene.environment.shows_color != 0u;
        const vec3 light = has_color ? vec3(context.scene.environment.visible_color)
                                     : sky_at(context.scene, ray.direction).radiance;
        add_light(path.found, context.view, path.throughput * light, path.way);
        return false;
    }
    ray = leaving(surface, ray.direction);
    return true;
}

SHADING_END

#endif
