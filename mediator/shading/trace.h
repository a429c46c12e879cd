#ifndef TESSERA_MEDIATOR_SHADING_TRACE_H
#define TESSERA_MEDIATOR_SHADING_TRACE_H

#include "mediator/shading/camera.h"
#include "mediator/shading/coverage.h"
#include "mediator/shading/shadow_catcher.h"
#include "mediator/shading/speculars.h"

// One sample, a pure function of (scene, view, pixel, index); of its context's time that is sample_time.
//
// Path tracing: unidirectional; Russian roulette from the fourth vertex on, by the largest component of the
// throughput. The renderer Whitted: emission and sky along all branches of perfect speculars, and where one
// ends on a surface direct light, as path tracing finds it with max_bounces = 0; the features of a sample are
// the branches' by their weights, the normal by their probabilities. The range is that of all branches in
// both. The renderer Raster is Whitted from first hits that a rasteriser has found (raster.h). The renderer
// Coverage finds the first hit alone.
//
// All rays but those to lights are asked for at one place and shaded at one place: a shader has all its
// functions inlined, and what is written twice is compiled twice. The including side says whether its views
// may ask for trees of perfect speculars (the renderer Whitted, or the range):
//   bool has_specular_trees(IN(Context) context)
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

// What a ray is for: the next step of a path; a branch of perfect speculars; from a branch's end, to find by
// chance what shines on it.
inline constexpr uint StagePath = 0u, StageBranch = 1u, StageGather = 2u;

// From a hit to the next ray; false: there is none.
WITH_CONTEXT inline bool leave_vertex(IN(Context) context, INOUT(Path) path, INOUT(Ray) ray,
                                      INOUT(uint) stage, IN(Surface) surface) {
    add_emission(context, path, ray, surface);
    if (stage == StageGather) return false;
    Lobe lobe = rough_lobe(path);
    if (stage == StagePath) {
        lobe = choose_lobe(path, surface, lobe);
        if (lobe.kind == LobeNone) return false;
    } else {
        if (!(surface.rough_share > 0.0f)) return false;
        path.probability *= lobe_chances(surface).rough;
    }
    if (lobe.kind == LobeRough && path.way.scatterings == 0u) {
        path.found.albedo += surface.albedo * surface.rough_share * path.throughput;
        path.found.normal += path.probability * surface.frame[2];
    }
    if (!surface.scatters) return false;
    if (stage == StagePath && path.vertex >= context.view.max_scatterings) return false;
    vec3 direction = vec3(0.0f);
    if (lobe.kind == LobeRough) {
        const vec3 wo = to_local(surface, -ray.direction);
        add_lights(context, path, surface, wo);
        if (!scatter(context.scene.energy, context.view, path, surface, wo, lobe, direction)) return false;
    } else {
        direction = pass_on(context, path, surface, lobe);
    }
    if (stage == StagePath) {
        if (!survives(path, lobe.roulette)) return false;
    } else {
        stage = StageGather;
    }
    ray = leaving(surface, direction);
    path.vertex += 1u;
    return true;
}

// What the camera sees, where that is known before the sample is traced; its instance may be NoInstance.
struct FirstHit {
    bool is_known;
    Hit hit;
};

WITH_CONTEXT inline Path trace_from(IN(Context) context, Path path, Ray ray, IN(FirstHit) seen) {
    const bool covers = context.view.renderer == RendererCoverage;
    const bool whitted =
        has_specular_trees(context) && context.view.renderer != RendererPathTracing && !covers;
    const bool wants_range = has_specular_trees(context) && keeps(context.view, KeepsRange);
    tell_camera(context, ray);
    const Ray camera = ray;
    bool is_caught = false;  // by a shadow catcher, and has met nothing since
    path.cone = camera_cone(context.view, ray, path.numbers.index);
    Branch branch = root_branch(ray, path.cone);
    BranchStack open;
    open.count = 0u;
    uint stage = whitted ? StageBranch : StagePath;
    while (true) {
        const bool first = path.rays == 0u;
        // The tree of a path is followed, after the path itself, for its range alone.
        const bool lit = !covers && (whitted || stage == StagePath);
        bool goes_on = false;
        path.rays += 1u;
        Hit hit;
        bool is_hit = false;
        if (first && seen.is_known) {
            hit = seen.hit;
            is_hit = hit.instance != NoInstance;
        } else {
            is_hit = trace_closest(context, ray, closest_seed(path), hit);
        }
        if (lit && !is_caught) add_shapes(context, path, ray, is_hit ? hit.distance : infinity());
        if (is_hit && covers) {
            show_object(path.found, context.scene.instances.items[hit.instance].object,
                        depth_along(context.view, ray, hit.distance));
        } else if (is_hit) {
            path.cone.width += path.cone.spread * hit.distance;
            const Surface surface =
                make_surface(context.scene, hit, ray.direction, path.cone.width, context.time);
            tell_hit(context, surface, path.throughput);
            if (first) {
                path.found.depth = depth_along(view_at(context.scene.features, context.view, context.time),
                                               ray, hit.distance);
                path.found.object = surface.object;
                path.found.alpha = 1.0f;
            }
            const bool catches_path = catches(context.scene, surface);
            if (catches_path && is_caught) {
                show_background(context, path, camera);
            } else if (catches_path && first) {
                is_caught = true;
                goes_on = true;
                ray = caught(path, surface);
                if (stage == StageBranch) stage = StageGather;
            } else if (catches_path) {
                goes_on = pass_catcher(context, path, ray, surface);
            } else {
                is_caught = false;
                if (stage == StageBranch || (first && wants_range)) {
                    if (wants_range) path.found.range += range_at(branch, surface);
                    push_children(open, branch, path.cone, surface, channel_of(path.numbers));
                }
                if (lit) goes_on = leave_vertex(context, path, ray, stage, surface);
            }
        } else {
            tell_miss(context);
            if (is_caught) {
                show_background(context, path, camera);
            } else if (lit) {
                leave_scene(context, path, ray, first);
            }
        }
        if (!goes_on) {
            if (open.count == 0u) return path;
            open.count -= 1u;
            branch = open.branches[open.count];
            enter_branch(path, branch);
            ray = branch.ray;
            stage = StageBranch;
        }
    }
}

WITH_CONTEXT inline Path trace_sample(IN(Context) context, uint x, uint y, uint64_t index) {
    const Path path = start_path(make_sampler(x, y, context.view.seed, index));
    const vec2 lens =
        (context.view.camera & CameraLens) != 0u ? sample_pair(path.numbers, LensPair) : vec2(0.5f);
    View view = view_at(context.scene.features, context.view, context.time);
    const Ray ray = camera_ray(view, x, y, sample_pair(path.numbers, CameraPair), lens);
    FirstHit unknown;
    unknown.is_known = false;
    return trace_from(context, path, ray, unknown);
}

SHADING_END

#endif
