#ifndef TESSERA_MEDIATOR_SHADING_PATH_STATE_H
#define TESSERA_MEDIATOR_SHADING_PATH_STATE_H

#include "mediator/shading/camera.h"
#include "mediator/shading/object_id.h"
#include "mediator/shading/shadow_catcher.h"
#include "mediator/shading/specular_branches.h"

// One sample as a state machine, ray by ray: what the next ray is for, what it hits, and the segment up to
// there.
SHADING_BEGIN

// The state of a sample: its path, the ray to trace next, and what is deferred until that ray has ended.
struct PathState {
    Path path;
    Ray ray;
    MediumTraversal traversal;  // of the ray, since the last surface
    uint stage;
    bool branches;             // follow all branches of perfect speculars, for their light
    Connection connection;     // open: the ray is a shadow ray; the path's next ray is saved in it
    DeferredSegment deferred;  // active: the ray is traced; the equiangular sample of its segment comes first
    bool is_first;             // nothing has been hit yet
    bool passes;               // the rest of a branch: its medium has been handled
    bool caught_shadow;        // the camera ray hit a shadow catcher, and nothing since
};

// The camera ray's hit, if it is known beforehand (rasterised); its instance may be NoInstance.
struct FirstHit {
    bool is_known;
    Hit hit;
};

// The purpose of a ray.
inline constexpr uint RayExtends = 0u;   // extends the path to its next vertex
inline constexpr uint RayConnects = 1u;  // a shadow ray through boundaries without a surface and thin walls
inline constexpr uint RayResumes = 2u;   // was traced before; now continues to its end

// Where it ends.
inline constexpr uint EventMiss = 0u;
inline constexpr uint EventSurface = 1u;
inline constexpr uint EventBoundary =
    2u;  // a medium boundary without a surface, or with alpha that passes: the ray continues
inline constexpr uint EventScattering = 3u;   // a scattering point in a medium
inline constexpr uint EventEquiangular = 4u;  // the equiangular sample of its segment

struct PathEvent {
    uint purpose;
    uint kind;
    bool is_hit;
    Hit hit;
    float end;     // of the segment: the distance of the hit
    bool arrives;  // a connection reaches its light
    // Light that it finds counts: not for the object-ID renderer, nor for branches that are followed for the
    // headlight feature alone.
    bool is_lit;
    PathSegment segment;  // through a medium
    EquiangularSample light;
};

WITH_CONTEXT inline PathState begin_path(IN(Context) context, IN(Path) start, IN(Ray) camera) {
    const bool branches = has_specular_trees(context) && context.view.renderer != RendererPathTracing &&
                          context.view.renderer != RendererObjectId;
    PathState state =
        PathState(start, camera, new_traversal(camera.origin), branches ? StageBranch : StagePath, branches,
                  no_connection(), no_deferred_segment(), true, false, false);
    state.path.cone = camera_cone(context.view, camera, start.numbers.index);
    if ((context.scene.features & FeatureMedia) != 0u)
        state.path.containing_media = context.view.containing_media;
    return state;
}

inline void start_branch(INOUT(PathState) state, IN(Branch) branch) {
    path_from_branch(state.path, branch);
    state.ray = branch.ray;
    state.traversal = branch.traversal;
    state.stage = StageBranch;
    state.is_first = branch.first;
    state.passes = branch.passes;
}

// Evaluates the medium along the segment and chooses its equiangular sample.
WITH_CONTEXT inline void cross_medium(IN(Context) context, IN(PathState) state, INOUT(PathEvent) event) {
    const bool connects = event.purpose == RayConnects;
    const uint kind =
        connects ? SegmentTransmits : segment_kind(state.path, context.view, state.stage, state.passes);
    if (event.is_lit)
        event.light = sample_equiangular(context, state.path, state.ray, state.traversal, event.end, kind);
    event.segment = traverse_segment(context, state.path, state.ray, state.traversal,
                                     event.arrives && !state.connection.distant ? 1.0f : event.end, kind,
                                     event.light.is_equiangular ? event.light.distance : -1.0f);
    if (!(event.light.is_equiangular && largest(event.segment.equiangular) > 0.0f)) {
        event.light = at_free_flight_point(event.light, event.segment.distance, event.segment.density);
    }
}

// The only place where rays are traced, except unobstructed shadow rays. `first_hit`: of the camera ray.
WITH_CONTEXT inline PathEvent next_event(IN(Context) context, INOUT(PathState) state,
                                         IN(FirstHit) first_hit) {
    const bool opens = (context.scene.features & FeatureIndexMatchedMedia) != 0u;
    const bool connects = opens || (context.scene.features & FeatureThinGlass) != 0u;
    const bool has_media = (context.scene.features & FeatureMedia) != 0u;
    const bool scatters = (context.scene.features & FeatureScattering) != 0u;
    PathEvent event;
    event.purpose = RayExtends;
    if (scatters && state.deferred.is_active) event.purpose = RayResumes;
    if (connects && state.connection.is_open) event.purpose = RayConnects;
    Sampler numbers = path_ray_numbers(state.path);
    if (event.purpose == RayConnects) numbers = state.connection.numbers;
    if (event.purpose == RayResumes) {
        event.hit = state.deferred.hit;
        event.is_hit = state.deferred.is_hit;
    } else {
        state.path.rays += 1u;
        if (state.path.rays == 1u && first_hit.is_known) {
            event.hit = first_hit.hit;
            event.is_hit = first_hit.hit.instance != NoInstance;
        } else {
            Skip skip = state.traversal.skip;
            skip.unlit = event.purpose == RayConnects || passes_unlit(state.path);
            event.is_hit = trace_closest(context, state.ray, numbers, skip, event.hit);
        }
    }
    const bool is_boundary = opens && event.is_hit && passes_boundary(context.scene, event.hit, numbers);
    if (opens && event.purpose != RayResumes)
        finish_crossing(context.scene, state.traversal, state.path.containing_media,
                        event.is_hit && !is_boundary, event.hit);
    event.end = event.is_hit ? event.hit.distance : infinity();
    event.arrives =
        event.purpose == RayConnects && (state.connection.distant ? !event.is_hit : !(event.end < 1.0f));
    event.is_lit = context.view.renderer != RendererObjectId && (state.branches || state.stage == StagePath);
    event.segment = empty_segment();
    event.light = no_equiangular_sample();
    if (event.purpose == RayResumes) {
        event.segment = state.deferred.segment;
        event.light = state.deferred.light;
        state.deferred.is_active = false;
    } else if (has_media && state.path.containing_media.x != NoInstance &&
               (event.purpose == RayConnects || event.is_lit)) {
        cross_medium(context, state, event);
    }
    event.kind = event.is_hit ? EventSurface : EventMiss;
    if (is_boundary && !event.arrives) event.kind = EventBoundary;
    if (event.segment.scatters) event.kind = EventScattering;
    if (scatters && event.light.is_equiangular) event.kind = EventEquiangular;
    return event;
}

// A connection may go on through what it meets.
WITH_CONTEXT inline bool meets_thin_wall(IN(Context) context, IN(PathEvent) event) {
    if ((context.scene.features & FeatureThinGlass) == 0u) return false;
    return event.kind == EventSurface && !event.arrives && is_thin_wall(context.scene, event.hit.instance);
}

// Ends a connection, at its light or at a surface; false: the path ends as well.
WITH_CONTEXT inline bool end_connection(IN(Context) context, INOUT(PathState) state, IN(PathEvent) event) {
    if (event.arrives) {
        receive_light(context, state.path.found, state.connection.light, state.connection.intensity,
                      state.connection.class_info, unit_vector(state.ray.direction));
    }
    const bool goes_on = resume_path(state.connection, state.path, state.ray);
    state.traversal = new_traversal(state.ray.origin);
    if ((context.scene.features & FeatureScattering) != 0u && state.deferred.is_active)
        state.traversal = state.deferred.traversal;
    return goes_on;
}

SHADING_END

#endif
