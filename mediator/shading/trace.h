#ifndef TESSERA_MEDIATOR_SHADING_TRACE_H
#define TESSERA_MEDIATOR_SHADING_TRACE_H

#include "mediator/shading/camera.h"
#include "mediator/shading/whitted.h"

// The including side says whether its views may ask for trees of perfect speculars (the Whitted renderer, or
// the range channel): bool has_specular_trees(IN(Context) context). A kernel without is much smaller.
//
// One sample, a pure function of (scene, view, pixel, index). Unidirectional; Russian roulette from the
// fourth vertex on, by the largest component of the throughput.
SHADING_BEGIN

inline constexpr uint RouletteFrom = 3u;  // vertices that are never cut short
// From here on nothing goes on for certain: a path that perfect mirrors or total reflection keep inside of a
// body has to end. Diffuse paths do not come so far: albedo 0.99 survives 1024 times in 30,000.
inline constexpr uint NothingCertainFrom = 1024u;

inline bool survives(INOUT(Path) path, float choice) {
    if (path.vertex >= RouletteFrom) {
        const float most = path.vertex >= NothingCertainFrom ? 0.95f : 1.0f;
        const float probability = lesser_of(largest(path.throughput), most);
        if (!(choice < probability)) return false;
        path.throughput /= probability;
    }
    return largest(path.throughput) > 0.0f;
}

// What only the camera's hit tells. False: the sample is finished.
WITH_CONTEXT inline bool see_first(IN(Context) context, INOUT(Path) path, IN(Ray) ray, IN(Surface) surface,
                                   float distance) {
    path.found.depth = depth_along(context.view, ray, distance);
    path.found.object = surface.object;
    const bool whitted = context.view.renderer == RendererWhitted;
    uint what = whitted ? FindLight : 0u;
    if (keeps(context.view, KeepsRange)) what |= FindRange;
    if (has_specular_trees(context) && what != 0u) follow_speculars(context, path, ray, surface, what);
    path.vertex = 0u;
    return !whitted;
}

// From a hit to the next ray; false: the path is finished.
WITH_CONTEXT inline bool leave_vertex(IN(Context) context, INOUT(Path) path, INOUT(Ray) ray,
                                      IN(Surface) surface) {
    add_emission(context, path, ray, surface);
    const Lobe lobe = choose_lobe(path, surface);
    if (lobe.kind == LobeNone) return false;
    if (lobe.kind == LobeRough && path.way.scatterings == 0u) {
        path.found.albedo = surface.albedo * surface.rough_share * path.throughput;
        path.found.normal = surface.frame[2];
    }
    if (!surface.scatters || path.vertex >= context.view.max_scatterings) return false;
    if (lobe.kind == LobeRough) {
        const vec3 wo = to_local(surface, -ray.direction);
        add_lights(context, path, surface, wo);
        if (!scatter(context.view, path, surface, wo, lobe, ray)) return false;
    } else {
        pass_on(context, path, surface, lobe, ray);
    }
    if (!survives(path, lobe.roulette)) return false;
    path.vertex += 1u;
    return true;
}

WITH_CONTEXT inline Path trace_sample(IN(Context) context, uint x, uint y, uint64_t index) {
    Path path = start_path(make_sampler(x, y, context.view.seed, index));
    Ray ray = camera_ray(context.view, x, y, sample_pair(path.numbers, CameraPair));
    tell_camera(context, ray);
    while (true) {
        path.rays += 1u;
        Hit hit;
        if (!trace_closest(context, ray, closest_seed(path), hit)) {
            tell_miss(context);
            if (path.vertex > 0u || context.view.transparent_background == 0u) add_sky(context, path, ray);
            return path;
        }
        const Surface surface = make_surface(context.scene, hit, ray.direction);
        tell_hit(context, surface, path.throughput);
        if (path.vertex == 0u && !see_first(context, path, ray, surface, hit.distance)) return path;
        if (!leave_vertex(context, path, ray, surface)) return path;
    }
}

SHADING_END

#endif
