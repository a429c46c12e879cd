#ifndef TESSERA_MEDIATOR_SHADING_WALK_H
#define TESSERA_MEDIATOR_SHADING_WALK_H

#include "mediator/shading/camera.h"
#include "mediator/shading/coverage.h"
#include "mediator/shading/shadow_catcher.h"
#include "mediator/shading/speculars.h"

// One sample ray by ray: what the next ray is for, what it meets, and what lies on the way there.
SHADING_BEGIN

// Where a sample stands: its path with the ray that is traced next, and what waits until that has come to an
// end.
struct Walk {
    Path path;
    Ray ray;
    Course course;  // of the ray, since the last surface
    uint stage;
    bool branches;          // all branches of perfect speculars are followed, for their light
    Connection connection;  // open: the ray is a shadow ray, and the path's own waits in it
    Held held;              // on: the ray has been traced; a place of its leg comes first
    bool is_first;          // nothing has been met yet
    bool passes;            // the rest of a branch: its medium has been dealt with
    bool is_caught;         // by a shadow catcher, and has met nothing since
};

// What the camera sees, where that is known before the sample is traced; its instance may be NoInstance.
struct FirstHit {
    bool is_known;
    Hit hit;
};

// What a ray is for.
inline constexpr uint RayExtends = 0u;   // the path, to its next vertex
inline constexpr uint RayConnects = 1u;  // the path's vertex and a light, through bodies without a surface
inline constexpr uint RayResumes = 2u;   // it was traced before, and now goes on to its end

// What it comes to.
inline constexpr uint MeetsNothing = 0u;
inline constexpr uint MeetsSurface = 1u;
inline constexpr uint MeetsBoundary =
    2u;  // one without a surface, or of alpha that lets through: the ray goes on
inline constexpr uint MeetsMedium = 3u;  // the path is scattered on the way
inline constexpr uint MeetsLight = 4u;   // at a place of its leg that equiangular sampling has chosen

struct Meeting {
    uint purpose;
    uint event;
    bool is_hit;
    Hit hit;
    float end;     // of the ray: the distance of the hit
    bool arrives;  // a connection, at its light
    // What it meets lights the sample: not so for coverage, nor where the tree of a path is followed, after the
    // path itself, for its range alone.
    bool is_lit;
    Leg leg;  // through a medium
    LegLight light;
};

WITH_CONTEXT inline Walk begin_walk(IN(Context) context, IN(Path) start, IN(Ray) camera) {
    const bool branches = has_specular_trees(context) && context.view.renderer != RendererPathTracing &&
                          context.view.renderer != RendererCoverage;
    Walk walk = Walk(start, camera, new_course(camera.origin), branches ? StageBranch : StagePath, branches,
                     no_connection(), hold_nothing(), true, false, false);
    walk.path.cone = camera_cone(context.view, camera, start.numbers.index);
    if ((context.scene.features & FeatureMedia) != 0u) walk.path.inside = context.view.inside;
    return walk;
}

inline void follow_branch(INOUT(Walk) walk, IN(Branch) branch) {
    enter_branch(walk.path, branch);
    walk.ray = branch.ray;
    walk.course = branch.course;
    walk.stage = StageBranch;
    walk.is_first = branch.first;
    walk.passes = branch.passes;
}

// What lies on the way, and the place on it where light is looked for.
WITH_CONTEXT inline void cross_medium(IN(Context) context, IN(Walk) walk, INOUT(Meeting) met) {
    const bool connects = met.purpose == RayConnects;
    const uint kind =
        connects ? LegPasses : leg_kind(walk.path, walk.stage, walk.passes, context.view.max_scatterings);
    if (met.is_lit) met.light = light_leg(context, walk.path, walk.ray, walk.course, met.end, kind);
    met.leg = leg_of(context, walk.path, walk.ray, walk.course,
                     met.arrives && !walk.connection.distant ? 1.0f : met.end, kind,
                     met.light.is_aside ? met.light.distance : -1.0f);
    if (!(met.light.is_aside && largest(met.leg.aside) > 0.0f)) {
        met.light = at_own_place(met.light, met.leg.distance, met.leg.density);
    }
}

// The only place where rays are traced but for those to lights through nothing. `seen`: of the first.
WITH_CONTEXT inline Meeting meet_next(IN(Context) context, INOUT(Walk) walk, IN(FirstHit) seen) {
    const bool opens = (context.scene.features & FeatureOpenMedia) != 0u;
    const bool has_media = (context.scene.features & FeatureMedia) != 0u;
    const bool scatters = (context.scene.features & FeatureScattering) != 0u;
    Meeting met;
    met.purpose = RayExtends;
    if (scatters && walk.held.is_on) met.purpose = RayResumes;
    if (opens && walk.connection.is_open) met.purpose = RayConnects;
    const uint seed = met.purpose == RayConnects ? walk.connection.seed : closest_seed(walk.path);
    if (met.purpose == RayResumes) {
        met.hit = walk.held.hit;
        met.is_hit = walk.held.is_hit;
    } else {
        walk.path.rays += 1u;
        if (walk.path.rays == 1u && seen.is_known) {
            met.hit = seen.hit;
            met.is_hit = seen.hit.instance != NoInstance;
        } else {
            met.is_hit = trace_closest(context, walk.ray, seed, walk.course.skip, met.hit);
        }
    }
    const bool is_boundary = opens && met.is_hit && passes_boundary(context.scene, met.hit, seed);
    if (opens && met.purpose != RayResumes)
        come_through(context.scene, walk.course, walk.path.inside, met.is_hit && !is_boundary, met.hit);
    met.end = met.is_hit ? met.hit.distance : infinity();
    met.arrives = met.purpose == RayConnects && (walk.connection.distant ? !met.is_hit : !(met.end < 1.0f));
    met.is_lit = context.view.renderer != RendererCoverage && (walk.branches || walk.stage == StagePath);
    met.leg = clear_leg();
    met.light = no_leg_light();
    if (met.purpose == RayResumes) {
        met.leg = walk.held.leg;
        met.light = walk.held.light;
        walk.held.is_on = false;
    } else if (has_media && walk.path.inside.x != NoInstance && (met.purpose == RayConnects || met.is_lit)) {
        cross_medium(context, walk, met);
    }
    met.event = met.is_hit ? MeetsSurface : MeetsNothing;
    if (is_boundary && !met.arrives) met.event = MeetsBoundary;
    if (met.leg.scatters) met.event = MeetsMedium;
    if (scatters && met.light.is_aside) met.event = MeetsLight;
    return met;
}

// A connection that ends at its light or at a surface; false: so does the path.
WITH_CONTEXT inline bool end_connection(IN(Context) context, INOUT(Walk) walk, IN(Meeting) met) {
    if (met.arrives) {
        receive_light(context, walk.path.found, walk.connection.light, walk.connection.intensity,
                      walk.connection.way, unit_vector(walk.ray.direction));
    }
    const bool goes_on = go_on_with_path(walk.connection, walk.path, walk.ray);
    walk.course = new_course(walk.ray.origin);
    if ((context.scene.features & FeatureScattering) != 0u && walk.held.is_on) walk.course = walk.held.course;
    return goes_on;
}

SHADING_END

#endif
