#ifndef TESSERA_MEDIATOR_SHADING_TRACE_H
#define TESSERA_MEDIATOR_SHADING_TRACE_H

#include "mediator/shading/walk.h"

// One sample, a pure function of (scene, view, pixel, index); of its context's time that is sample_time.
//
// Path tracing: unidirectional; Russian roulette from the fourth vertex on, by the largest component of the
// throughput. The renderer Whitted: emission and sky along all branches of perfect speculars, and where one
// ends on a surface direct light, as path tracing finds it with max_bounces = 0; the features of a sample are
// the branches' by their weights, the normal by their probabilities. The range is that of all branches in
// both. The renderer Raster is Whitted from first hits that a rasteriser has found (raster.h). The renderer
// Coverage finds the first hit alone.
//
// All rays but those to lights are traced at one place (meet_next) and shaded at one place (meet_vertex): a
// shader has all its functions inlined, and what is written twice is compiled twice. The including side says whether its views
// may ask for trees of perfect speculars (the renderer Whitted, or the range):
//   bool has_specular_trees(IN(Context) context)
SHADING_BEGIN

inline constexpr uint RouletteFrom = 3u;  // vertices that are never cut short
// From here on nothing goes on for certain: a path that perfect mirrors or total reflection keep inside of a
// body has to end. Diffuse paths do not come so far: albedo 0.99 survives 1024 times in 30,000.
inline constexpr uint NothingCertainFrom = 1024u;

// Light finds its way out of dense media, slowly: of paths in a half space that absorbs nothing, one in
// sqrt(pi n) is scattered more than n times.
inline constexpr uint NothingCertainInMediaFrom = 65536u;

inline bool survives(INOUT(Path) path, uint nothing_certain_from, float choice) {
    if (path.vertex >= RouletteFrom) {
        const float most = path.vertex >= nothing_certain_from ? 0.95f : 1.0f;
        const float probability = lesser_of(largest(path.throughput), most);
        if (!(choice < probability)) return false;
        path.throughput /= probability;
    }
    return largest(path.throughput) > 0.0f;
}

// From a hit to the next ray; false: there is none.
WITH_CONTEXT inline bool leave_vertex(IN(Context) context, INOUT(Path) path, INOUT(Ray) ray,
                                      INOUT(uint) stage, IN(Surface) surface, IN(LegLight) leg,
                                      INOUT(Connection) connection) {
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
    if (lobe.kind == LobeRough && path.way.scatterings == 0u && !leg.is_aside) {
        path.found.albedo += surface.albedo * surface.rough_share * path.throughput;
        if (!is_in_medium(surface)) path.found.normal += path.probability * surface.frame[2];
    }
    if (!surface.scatters) return false;
    if (stage == StagePath && !leg.is_aside && path.vertex >= context.view.max_scatterings) return false;
    vec3 direction = vec3(0.0f);
    if (lobe.kind == LobeRough) {
        const vec3 wo = to_local(surface, -ray.direction);
        add_lights(context, path, surface, wo, leg, connection);
        if (leg.is_aside) return true;
        if (!scatter(context.scene.energy, context.view, path, surface, wo, lobe, direction)) return false;
    } else {
        direction = pass_on(context, path, surface, lobe);
    }
    if (stage == StagePath) {
        const uint end = is_in_medium(surface) ? NothingCertainInMediaFrom : NothingCertainFrom;
        if (!survives(path, end, lobe.roulette)) return false;
    } else {
        stage = StageGather;
    }
    ray = leaving(surface, direction);
    path.inside = inside_after(context.scene, path.inside, surface, direction);
    path.vertex += 1u;
    return true;
}

// What the leg there adds to the sample, and leaves of the throughput.
WITH_CONTEXT inline void gather_along(IN(Context) context, INOUT(Walk) walk, INOUT(Branch) branch,
                                      INOUT(BranchStack) open, INOUT(Meeting) met) {
    if (met.is_lit && met.event != MeetsLight && !walk.passes) {
        if (!walk.is_caught) add_shapes(context, walk.path, walk.ray, walk.course.begun, met.end);
        if (largest(met.leg.emitted) > 0.0f) {
            add_light(walk.path.found, context.view, walk.path.throughput * met.leg.emitted, walk.path.way);
        }
    }
    if (met.event == MeetsLight) {
        walk.held = Held(true, met.is_hit, met.hit, met.leg,
                         at_own_place(met.light, met.leg.distance, met.leg.density), walk.course,
                         walk.path.throughput, walk.path.vertex);
        met.light.density = met.leg.aside_density;
        walk.path.vertex = aside_vertex(walk.path.vertex, walk.course.number);
        walk.path.throughput *= met.leg.aside / met.light.pdf;
    } else if (met.event == MeetsMedium) {
        if (walk.stage == StageBranch) {
            push_rest(open, branch, walk.path, walk.ray, walk.course, walk.is_first);
            walk.path.vertex += MediumVertex;
        }
        walk.path.throughput *= met.leg.scattered;
    } else {
        walk.path.throughput *= met.leg.passed;
        if (walk.stage == StageBranch) branch.weight = walk.path.throughput;
    }
    if (met.event != MeetsLight) walk.passes = false;
}

// The features of the sample that are those of the first surface.
WITH_CONTEXT inline void show_first(IN(Context) context, INOUT(PathSample) found, IN(Surface) surface,
                                    IN(Ray) ray, float distance) {
    const bool moves = (context.scene.features & FeatureCameraMotion) != 0u;
    found.depth = moves ? moving_depth_along(context.view, context.time, ray.direction, distance)
                        : depth_along(context.view, ray, distance);
    found.object = surface.object;
    found.alpha = 1.0f;
}

// False: the path or branch ends.
WITH_CONTEXT inline bool meet_catcher(IN(Context) context, INOUT(Walk) walk, IN(Surface) surface,
                                      IN(Ray) camera) {
    bool goes_on = false;
    if (walk.is_caught) {
        show_background(context, walk.path, camera);
    } else if (walk.is_first) {
        walk.is_caught = true;
        walk.ray = caught(walk.path, surface);
        if (walk.stage == StageBranch) walk.stage = StageGather;
        goes_on = true;
    } else {
        goes_on = pass_catcher(context, walk.path, walk.ray, surface);
    }
    return goes_on;
}

// A surface that shows itself, or a place in a medium; false: the path or branch ends.
WITH_CONTEXT inline bool meet_scatterer(IN(Context) context, INOUT(Walk) walk, IN(Branch) branch,
                                        INOUT(BranchStack) open, IN(Surface) surface, IN(Meeting) met) {
    const bool wants_range = has_specular_trees(context) && keeps(context.view, KeepsRange);
    const bool is_aside = met.event == MeetsLight;
    LegLight light = no_leg_light();
    if (met.event != MeetsSurface) light = met.light;
    if (!is_aside) walk.is_caught = false;
    if (met.event == MeetsSurface && (walk.stage == StageBranch || (walk.is_first && wants_range))) {
        if (wants_range) walk.path.found.range += range_at(branch, surface);
        push_children(open, context.scene, branch, walk.path.cone, walk.path.inside, surface,
                      channel_of(walk.path.numbers));
    }
    bool goes_on = false;
    if (met.is_lit) {
        goes_on = leave_vertex(context, walk.path, walk.ray, walk.stage, surface, light, walk.connection);
    }
    if (is_aside) {
        walk.path.throughput = walk.held.throughput;
        walk.path.vertex = walk.held.vertex;
        goes_on = true;
    }
    if ((context.scene.features & FeatureOpenMedia) != 0u && walk.connection.is_open) {
        goes_on = look_for_light(walk.connection, walk.path, walk.ray, goes_on);
    }
    return goes_on;
}

// A vertex of the path, or of its connection to a light from a place of its leg; false: the path or branch ends.
WITH_CONTEXT inline bool meet_vertex(IN(Context) context, INOUT(Walk) walk, IN(Branch) branch,
                                     INOUT(BranchStack) open, IN(Meeting) met, IN(Ray) camera) {
    const bool in_medium = met.event != MeetsSurface;
    const bool is_aside = met.event == MeetsLight;
    const float along = is_aside ? met.light.distance : met.leg.distance;
    const float distance = in_medium ? walk.course.begun + along : met.end;
    if (!is_aside) walk.path.cone.width += walk.path.cone.spread * (distance - walk.course.begun);
    // At once: a surface is large, and to copy it takes longer than to skip all that it does not have.
    const Surface surface =
        in_medium ? scattering_place(walk.course.start + along * walk.ray.direction, walk.ray.direction,
                                     met.leg.anisotropy,
                                     context.scene.instances.items[walk.path.inside.x].object, context.time)
                  : make_surface(context.scene, met.hit, walk.ray.direction, walk.path.cone.width,
                                 walk.path.inside, context.time);
    tell_hit(context, surface, walk.path.throughput);
    const bool on_the_way = is_aside || (in_medium && walk.stage == StageBranch);
    if (walk.is_first && !on_the_way) show_first(context, walk.path.found, surface, walk.ray, distance);
    bool goes_on = false;
    if (catches(context.scene, surface)) {
        goes_on = meet_catcher(context, walk, surface, camera);
    } else {
        goes_on = meet_scatterer(context, walk, branch, open, surface, met);
    }
    const bool has_media = (context.scene.features & FeatureMedia) != 0u;
    if (has_media && (!is_aside || walk.connection.is_open)) walk.course = new_course(walk.ray.origin);
    if (!is_aside) walk.is_first = false;
    return goes_on;
}

WITH_CONTEXT inline Path trace_from(IN(Context) context, IN(Path) start, IN(Ray) camera, IN(FirstHit) seen) {
    tell_camera(context, camera);
    Walk walk = begin_walk(context, start, camera);
    Branch branch = root_branch(camera, walk.path.cone);
    BranchStack open;
    open.count = 0u;
    while (true) {
        Meeting met = meet_next(context, walk, seen);
        if (met.purpose == RayConnects) {
            walk.connection.light *= met.leg.passed;
        } else {
            gather_along(context, walk, branch, open, met);
        }
        bool goes_on = false;
        if (met.event == MeetsBoundary) {
            if (met.purpose != RayConnects)
                walk.path.cone.width += walk.path.cone.spread * (met.end - walk.course.begun);
            go_through(context.scene, walk.course, walk.path.inside, met.hit, walk.ray, context.time);
            goes_on = true;
        } else if (met.purpose == RayConnects) {
            goes_on = end_connection(context, walk, met);
        } else if (met.event == MeetsNothing) {
            tell_miss(context);
            if (walk.is_caught) {
                show_background(context, walk.path, camera);
            } else if (met.is_lit) {
                leave_scene(context, walk.path, walk.ray, walk.is_first);
            }
            walk.is_first = false;
        } else if (context.view.renderer == RendererCoverage) {
            show_object(walk.path.found, context.scene.instances.items[met.hit.instance].object,
                        depth_along(context.view, walk.ray, met.end));
        } else {
            goes_on = meet_vertex(context, walk, branch, open, met, camera);
        }
        if (goes_on) continue;
        if (open.count == 0u) return walk.path;
        open.count -= 1u;
        branch = open.branches[open.count];
        follow_branch(walk, branch);
    }
}

WITH_CONTEXT inline Path trace_sample(IN(Context) context, uint x, uint y, uint64_t index) {
    const Path path = start_path(make_sampler(x, y, context.view.seed, index));
    const vec2 lens =
        (context.view.camera & CameraLens) != 0u ? sample_pair(path.numbers, LensPair) : vec2(0.5f);
    const vec2 u = sample_pair(path.numbers, CameraPair);
    const bool moves = (context.scene.features & FeatureCameraMotion) != 0u;
    const Ray ray = moves ? moving_camera_ray(context.view, context.time, x, y, u, lens)
                          : camera_ray(context.view, x, y, u, lens);
    FirstHit unknown;
    unknown.is_known = false;
    return trace_from(context, path, ray, unknown);
}

SHADING_END

#endif
