#ifndef TESSERA_MEDIATOR_SHADING_COURSES_H
#define TESSERA_MEDIATOR_SHADING_COURSES_H

#include "mediator/shading/transport.h"

// Rays through media: legs from boundary to boundary, and light that is looked for along them.
SHADING_BEGIN

// What a ray is for: the next step of a path; a branch of perfect speculars; from a branch's end, to find by
// chance what shines on it.
inline constexpr uint StagePath = 0u, StageBranch = 1u, StageGather = 2u;

// How far a ray has come through boundaries without a surface (trace.h).
struct Course {
    Skip skip;    // the last of them, which counts once it is known what the ray meets next
    bool enters;  // its body
    float begun;  // where the leg begins,
    vec3 start;   // more exactly than the ray can tell
    uint number;  // of the leg
};

inline Course new_course(vec3 origin) {
    return Course(skip_nothing(), false, 0.0f, origin, 0u);
}

// A path is scattered by chance, or once on each leg of a branch of perfect speculars, for single scattering;
// not where no scattering would count.
inline uint leg_kind(IN(Path) path, uint stage, bool passes, uint max_scatterings) {
    if (stage == StageBranch && !passes) return LegScatters;
    return stage == StagePath && path.vertex < max_scatterings ? LegMayScatter : LegPasses;
}

// Random numbers of a place aside are those of a vertex that no path has.
inline uint aside_vertex(uint vertex, uint leg) {
    return vertex + 0x18000000u + (leg & 15u) * 0x00400000u;
}

// Whether light is looked for at a place aside of a leg to `end`, and where.
WITH_CONTEXT inline LegLight light_leg(IN(Context) context, IN(Path) path, IN(Ray) ray, IN(Course) course,
                                       float end, uint kind) {
    LegLight leg = no_leg_light();
    if ((context.scene.features & FeatureScattering) == 0u || kind == LegPasses) return leg;
    if (context.scene.tree_light_count == 0u || path.inside.x == NoInstance || !is_finite(end)) return leg;
    if (context.view.strategy == StrategyFlightOnly) return leg;
    const int body = context.scene.instances.items[path.inside.x].body;
    if (!(largest(context.scene.bodies.items[body].scattering) > 0.0f)) return leg;
    Path aside = path;
    aside.vertex = aside_vertex(path.vertex, course.number);
    leg.is_on = true;
    leg.span = Span(course.start, ray.direction, greater_of(end - course.begun, 0.0f));
    leg.chosen = choose_emitter(context.scene, receiver_along(leg.span), pair_at(aside, PairLightChoice));
    const SpanView seen = seen_from(context.scene, leg.span, leg.chosen.index);
    leg.distance = equiangular_distance(seen, pair_at(aside, PairBsdfDirection).x);
    leg.pdf = equiangular_pdf(seen, leg.distance);
    leg.is_aside = leg.pdf > 0.0f;
    return leg;
}

// From where it begins to `end`, in lengths of the ray's direction. `aside`: a place of it that is asked for.
WITH_CONTEXT inline Leg leg_of(IN(Context) context, IN(Path) path, IN(Ray) ray, IN(Course) course, float end,
                               uint kind, float aside) {
    if ((context.scene.features & FeatureMedia) == 0u || path.inside.x == NoInstance) return clear_leg();
    const float size = vector_length(ray.direction);
    const uint pair = leg_pair(path.vertex, course.number);
    vec2 u = vec2(0.0f);
    if (kind != LegPasses) u = sample_pair(path.numbers, pair);
    const float place = unit_float(hash_combine(path.numbers.seed, pair ^ path.numbers.index));
    LegQuestion question = ask_leg(kind, path.throughput, u, place);
    question.aside = aside;
    return leg_through(context.scene, path.inside, course.start, ray.direction / size,
                       greater_of(end - course.begun, 0.0f) * size, question, context.time);
}

// A boundary without a surface: the same ray goes on, and passes it by. Surfaces that lie in the boundary are
// found all the same, as far as rounding may take them apart; then the ray has not come through.
inline void go_through(IN(Scene) scene, INOUT(Course) course, INOUT(uvec4) inside, IN(Hit) hit, IN(Ray) ray,
                       float time) {
    const Boundary boundary = boundary_at(scene, hit, ray.direction, time);
    const float tolerance =
        2.0f * dot(abs(boundary.normal), boundary.error) / abs(dot(boundary.normal, ray.direction)) +
        rounding_bound(16.0f) * hit.distance;
    const bool at_another = course.skip.instance != NoInstance && hit.distance <= course.skip.far;
    course.begun = hit.distance;
    course.start = boundary.position;
    course.number += 1u;
    course.enters = boundary.enters;
    course.skip =
        Skip(hit.instance, greater_of(hit.distance - tolerance, NearestHit), hit.distance + tolerance);
    if (!at_another) return;
    // Two that lie in each other would be met in turn for ever.
    inside = crossed(scene, inside, hit.instance, boundary.enters);
    course.skip = Skip(NoInstance, hit.distance + tolerance, 0.0f);
}

// Once it is known what the ray meets next, and whether that is a surface.
inline void come_through(IN(Scene) scene, IN(Course) course, INOUT(uvec4) inside, bool meets_surface,
                         IN(Hit) hit) {
    if (course.skip.instance == NoInstance) return;
    if (!meets_surface || hit.distance > course.skip.far)
        inside = crossed(scene, inside, course.skip.instance, course.enters);
}

// What is known of a ray while light of a place aside of its leg is looked for.
struct Held {
    bool is_on;
    bool is_hit;
    Hit hit;
    Leg leg;
    LegLight light;
    Course course;
    vec3 throughput;
    uint vertex;
};

inline Held hold_nothing() {
    return Held(false, false, Hit(NoInstance, 0u, vec2(0.0f), 0.0f), clear_leg(), no_leg_light(),
                new_course(vec3(0.0f)), vec3(0.0f), 0u);
}

// The path waits with its next ray until the light has arrived or not.
inline bool look_for_light(INOUT(Connection) connection, INOUT(Path) path, INOUT(Ray) ray, bool goes_on) {
    const Ray toward = connection.resume;
    const uvec4 inside = connection.inside;
    connection.resume = ray;
    connection.resumes = goes_on;
    connection.inside = path.inside;
    ray = toward;
    path.inside = inside;
    return true;
}
inline bool go_on_with_path(INOUT(Connection) connection, INOUT(Path) path, INOUT(Ray) ray) {
    connection.is_open = false;
    ray = connection.resume;
    path.inside = connection.inside;
    return connection.resumes;
}

SHADING_END

#endif
