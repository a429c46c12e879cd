#ifndef TESSERA_MEDIATOR_SHADING_TRACE_H
#define TESSERA_MEDIATOR_SHADING_TRACE_H

#include "mediator/shading/path_state.h"

// Traces one sample: a pure function of (scene, view, pixel, index), if the context's time is sample_time.
//
// Path tracing: unidirectional, with Russian roulette from the second vertex on where the largest component of
// the throughput is small (LeastThroughput). The renderer Whitted adds emission and sky along all branches of perfect speculars and,
// where a branch ends on a surface, direct light as path tracing computes it with max_bounces = 0. Its
// features are the sums over the branches by weight, the normal by probability. The headlight feature is that
// of all branches in both. The renderer Raster is Whitted, starting from rasterised first hits (raster.h).
// The renderer "coverage" (RendererObjectId) traces the first hit only.
//
// All rays except shadow rays are traced in one place (next_event) and shaded in one place (shade_vertex):
// shader compilers inline every call, so code size grows with each call site. The including file defines
// whether its views may need trees of perfect speculars (the renderer Whitted, or the headlight feature):
//   bool has_specular_trees(IN(Context) context)
SHADING_BEGIN

inline constexpr uint RouletteFrom = 1u;  // vertices without Russian roulette
// Paths that carry less are subject to Russian roulette, and carry this if they survive. Sooner means shorter paths but more
// variance where few of them find bright light: with 1 instead of 1/4, from the fourth vertex on, relMSE times time was 2.2 times
// as large in a room behind windows and 1.2 times in one with an open side.
inline constexpr float LeastThroughput = 0.25f;
// From this vertex on the survival probability is below 1, so that paths trapped by perfect mirrors, by total reflection or
// between white walls end. Little light comes so late: 0.1 % in a closed room of albedo 0.9999, and in a half space of a
// medium without absorption, of which 1 in sqrt(pi n) paths scatters more than n times, 0.2 %.
inline constexpr uint RouletteAlwaysFrom = 65536u;

inline bool survives(INOUT(Path) path, float choice) {
    if (path.vertex >= RouletteFrom) {
        const float most = path.vertex >= RouletteAlwaysFrom ? 0.95f : 1.0f;
        const float probability = lesser_of(largest(path.throughput) / LeastThroughput, most);
        if (!(choice < probability)) return false;
        path.throughput /= probability;
    }
    return largest(path.throughput) > 0.0f;
}

// Direct light and scattering at a vertex; false: there is no next ray.
WITH_CONTEXT inline bool leave_vertex(IN(Context) context, INOUT(Path) path, INOUT(Ray) ray,
                                      INOUT(uint) stage, IN(Surface) surface,
                                      IN(EquiangularSample) equiangular, INOUT(Connection) connection) {
    add_emission(context, path, ray, surface);
    if (stage == StageGather) {
        if (!passes_straight(surface)) return false;
        path.throughput *= surface.specular.refraction;
        ray = leaving(surface, ray.direction);
        path.containing_media = media_after(context.scene, path.containing_media, surface, ray.direction);
        return true;
    }
    Lobe lobe = rough_lobe(path);
    if (stage == StagePath) {
        lobe = choose_lobe(path, surface, lobe);
        if (lobe.kind == LobeNone) return false;
    } else {
        if (!(surface.rough_fraction > 0.0f)) return false;
        path.probability *= lobe_chances(surface).rough;
    }
    if (lobe.kind == LobeRough && path.class_info.scatter_count == 0u && !equiangular.is_equiangular) {
        path.found.albedo += surface.albedo * surface.rough_fraction * path.throughput;
        if (!is_in_medium(surface)) path.found.normal += path.probability * surface.frame[2];
    }
    if (!surface.scatters) return false;
    const bool is_counted = stage == StagePath && !equiangular.is_equiangular;
    const bool is_straight = lobe.kind == LobeRefraction && passes_straight(surface);
    if (is_counted && !is_straight && !may_scatter(path, context.view, lobe.kind != LobeRough)) return false;
    vec3 direction = vec3(0.0f);
    if (lobe.kind == LobeRough) {
        const vec3 wo = to_local(surface, -ray.direction);
        const Receiver receiver = receiver_at(context.view, path.numbers.index, surface);
        if (!is_in_medium(surface)) log_receiver(context, receiver, leaving(surface, surface.frame[2]));
        add_lights(context, path, surface, receiver, wo, equiangular, lobe.roulette, connection);
        if (equiangular.is_equiangular) return true;
        if (!scatter(context.scene.energy, context.view, path, surface, receiver, wo, lobe, direction))
            return false;
    } else {
        direction = scatter_specular(context, path, surface, lobe, is_straight);
    }
    if (stage == StagePath) {
        if (!survives(path, lobe.roulette)) return false;
    } else {
        stage = StageGather;
    }
    ray = leaving(surface, direction);
    path.containing_media = media_after(context.scene, path.containing_media, surface, direction);
    path.vertex += 1u;
    return true;
}

// Adds the emission and lights along the segment to the sample, and attenuates the throughput.
WITH_CONTEXT inline void add_segment(IN(Context) context, INOUT(PathState) state, INOUT(Branch) branch,
                                     INOUT(BranchStack) stack, INOUT(PathEvent) event) {
    if (event.is_lit && event.kind != EventEquiangular && !state.passes) {
        if (!state.caught_shadow)
            add_area_lights(context, state.path, state.ray, state.traversal.segment_distance, event.end);
        if (largest(event.segment.emitted) > 0.0f) {
            add_light(state.path.found, context.view, state.path.throughput * event.segment.emitted,
                      state.path.class_info);
        }
    }
    if (event.kind == EventEquiangular) {
        state.deferred =
            DeferredSegment(true, event.is_hit, event.hit, event.segment,
                            at_free_flight_point(event.light, event.segment.distance, event.segment.density),
                            state.traversal, state.path.throughput, state.path.vertex);
        event.light.density = event.segment.equiangular_density;
        state.path.vertex = equiangular_vertex(state.path.vertex, state.traversal.segment_index);
        state.path.throughput *= event.segment.equiangular / event.light.pdf;
    } else if (event.kind == EventScattering) {
        if (state.stage == StageBranch) {
            push_rest(stack, branch, state.path, state.ray, state.traversal, state.is_first);
            state.path.vertex += MediumVertex;
        }
        state.path.throughput *= event.segment.scattered;
    } else {
        state.path.throughput *= event.segment.passed;
        if (state.stage == StageBranch) branch.weight = state.path.throughput;
    }
    if (event.kind != EventEquiangular) state.passes = false;
}

// Features of the sample that are taken from the first surface.
WITH_CONTEXT inline void record_first_hit(IN(Context) context, INOUT(PathSample) found, IN(Surface) surface,
                                          IN(Ray) ray, float distance) {
    const bool moves = (context.scene.features & FeatureCameraMotion) != 0u;
    found.depth = moves ? moving_depth_along(context.view, context.time, ray.direction, distance)
                        : depth_along(context.view, ray, distance);
    found.object = surface.object;
    found.alpha = 1.0f;
}

// A connection meets a surface; false: the path ends as well.
WITH_CONTEXT inline bool shade_connection(IN(Context) context, INOUT(PathState) state, IN(Surface) surface,
                                          IN(PathEvent) event) {
    if (!passes_straight(surface)) return end_connection(context, state, event);
    state.connection.light *= surface.specular.refraction;
    state.connection.intensity *= surface.specular.refraction;
    state.ray = leaving(surface, state.ray.direction);
    if (!state.connection.distant) state.ray.direction = state.connection.target - state.ray.origin;
    state.path.containing_media =
        media_after(context.scene, state.path.containing_media, surface, state.ray.direction);
    state.traversal = new_traversal(state.ray.origin);
    return true;
}

// False: the path or branch ends.
WITH_CONTEXT inline bool shade_catcher(IN(Context) context, INOUT(PathState) state, IN(Surface) surface,
                                       IN(Ray) camera) {
    bool goes_on = false;
    if (state.caught_shadow) {
        show_background(context, state.path, camera);
    } else if (state.is_first) {
        state.caught_shadow = true;
        state.ray = leave_catcher(state.path, surface);
        if (state.stage == StageBranch) state.stage = StageGather;
        goes_on = true;
    } else {
        goes_on = pass_catcher(context, state.path, state.ray, surface);
    }
    return goes_on;
}

// A surface that is no shadow catcher, or a point in a medium; false: the path or branch ends.
WITH_CONTEXT inline bool shade_scatterer(IN(Context) context, INOUT(PathState) state, IN(Branch) branch,
                                         INOUT(BranchStack) stack, IN(Surface) surface, IN(PathEvent) event) {
    const bool wants_headlight = has_specular_trees(context) && records(context.view, RecordsHeadlight);
    const bool is_equiangular = event.kind == EventEquiangular;
    EquiangularSample light = no_equiangular_sample();
    if (event.kind != EventSurface) light = event.light;
    if (!is_equiangular) state.caught_shadow = false;
    if (event.kind == EventSurface && (state.stage == StageBranch || (state.is_first && wants_headlight))) {
        if (wants_headlight) state.path.found.headlight += headlight_at(branch, surface);
        push_children(stack, context.scene, branch, state.path.cone, state.path.containing_media, surface,
                      channel_of(state.path.numbers));
    }
    bool goes_on = false;
    if (event.is_lit) {
        goes_on = leave_vertex(context, state.path, state.ray, state.stage, surface, light, state.connection);
    }
    if (is_equiangular) {
        state.path.throughput = state.deferred.throughput;
        state.path.vertex = state.deferred.vertex;
        goes_on = true;
    }
    const bool may_connect = (context.scene.features & (FeatureIndexMatchedMedia | FeatureThinGlass)) != 0u;
    if (may_connect && state.connection.is_open) {
        goes_on = start_connection(state.connection, state.path, state.ray, goes_on);
    }
    return goes_on;
}

// Shades a vertex of the path, or the equiangular sample of its segment; false: the path or branch ends.
WITH_CONTEXT inline bool shade_vertex(IN(Context) context, INOUT(PathState) state, IN(Branch) branch,
                                      INOUT(BranchStack) stack, IN(PathEvent) event, IN(Ray) camera) {
    const bool in_medium = event.kind != EventSurface;
    const bool is_equiangular = event.kind == EventEquiangular;
    const bool connects = (context.scene.features & FeatureThinGlass) != 0u && event.purpose == RayConnects;
    // Directions of connections have any length. What they pass is looked up at points.
    const vec3 arriving = connects ? unit_vector(state.ray.direction) : state.ray.direction;
    const float along = is_equiangular ? event.light.distance : event.segment.distance;
    const float distance = in_medium ? state.traversal.segment_distance + along : event.end;
    if (!is_equiangular && !connects)
        state.path.cone.width += state.path.cone.spread * (distance - state.traversal.segment_distance);
    // Constructed in place: a surface is large, and copying it would cost more than building it.
    const Surface surface =
        in_medium ? scattering_place(state.traversal.segment_start + along * state.ray.direction,
                                     state.ray.direction, event.segment.anisotropy,
                                     context.scene.instances.items[state.path.containing_media.x].object,
                                     context.time)
                  : make_surface(context.scene, event.hit, arriving, connects ? 0.0f : state.path.cone.width,
                                 state.path.containing_media, context.time);
    if (connects) return shade_connection(context, state, surface, event);
    log_hit(context, surface, state.path.throughput);
    const bool within_segment = is_equiangular || (in_medium && state.stage == StageBranch);
    if (state.is_first && !within_segment)
        record_first_hit(context, state.path.found, surface, state.ray, distance);
    bool goes_on = false;
    if (is_shadow_catcher(context.scene, surface)) {
        goes_on = shade_catcher(context, state, surface, camera);
    } else {
        goes_on = shade_scatterer(context, state, branch, stack, surface, event);
    }
    const bool has_media = (context.scene.features & FeatureMedia) != 0u;
    if (has_media && (!is_equiangular || state.connection.is_open))
        state.traversal = new_traversal(state.ray.origin);
    if (!is_equiangular) state.is_first = false;
    return goes_on;
}

WITH_CONTEXT inline Path trace_from(IN(Context) context, IN(Path) start, IN(Ray) camera,
                                    IN(FirstHit) first_hit) {
    log_camera(context, camera);
    PathState state = begin_path(context, start, camera);
    Branch branch = root_branch(camera, state.path.cone);
    BranchStack stack;
    stack.count = 0u;
    while (true) {
        PathEvent event = next_event(context, state, first_hit);
        if (event.purpose == RayConnects) {
            state.connection.light *= event.segment.passed;
        } else {
            add_segment(context, state, branch, stack, event);
        }
        bool goes_on = false;
        if (event.kind == EventBoundary) {
            if (event.purpose != RayConnects)
                state.path.cone.width +=
                    state.path.cone.spread * (event.end - state.traversal.segment_distance);
            cross_boundary(context.scene, state.traversal, state.path.containing_media, event.hit, state.ray,
                           context.time);
            goes_on = true;
        } else if (event.purpose == RayConnects && !meets_thin_wall(context, event)) {
            goes_on = end_connection(context, state, event);
        } else if (event.kind == EventMiss) {
            log_miss(context);
            if (state.caught_shadow) {
                show_background(context, state.path, camera);
            } else if (event.is_lit) {
                leave_scene(context, state.path, state.ray, state.is_first);
            }
            state.is_first = false;
        } else if (context.view.renderer == RendererObjectId) {
            record_object_id(state.path.found, context.scene.instances.items[event.hit.instance].object,
                             depth_along(context.view, state.ray, event.end));
        } else {
            goes_on = shade_vertex(context, state, branch, stack, event, camera);
        }
        if (goes_on) continue;
        if (stack.count == 0u) return state.path;
        stack.count -= 1u;
        branch = stack.branches[stack.count];
        start_branch(state, branch);
    }
}

WITH_CONTEXT inline Path trace_sample(IN(Context) context, uint x, uint y, uint64_t index) {
    const Path path = start_path(make_sampler(x, y, context.view.seed, index));
    const vec2 lens =
        (context.view.camera & CameraLens) != 0u ? sample_pair(path.numbers, LensSet) : vec2(0.5f);
    const vec2 u = sample_pair(path.numbers, CameraSet);
    const bool moves = (context.scene.features & FeatureCameraMotion) != 0u;
    const Ray ray = moves ? moving_camera_ray(context.view, context.time, x, y, u, lens)
                          : camera_ray(context.view, x, y, u, lens);
    FirstHit unknown;
    unknown.is_known = false;
    return trace_from(context, path, ray, unknown);
}

SHADING_END

#endif
