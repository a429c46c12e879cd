#ifndef TESSERA_TESTS_SHADING_MEDIA_CASES_H
#define TESSERA_TESTS_SHADING_MEDIA_CASES_H

#include "tests/shading/world_cases.h"

// What functions of media are called with: the same scene with bodies in it.
SHADING_BEGIN

// The scene with bodies; none in the dark one.
inline Context in_media(IN(Case) c) {
    Context context = c.context;
    if (context.scene.features != 0u) {
        context.scene.features = context.scene.features | FeatureMedia | FeatureOpenMedia |
                                 FeatureScattering | FeatureMediaTextures;
    }
    return context;
}
// Different bodies, by priority.
inline uvec4 in_bodies(IN(Case) c, IN(Inputs) x) {
    uvec4 inside = nowhere();
    Scene scene = in_media(c).scene;
    for (uint i = 0u; i < x.a % 5u; ++i) inside = entered(scene, inside, (x.b + i) % 7u);
    return inside;
}
inline Texture volume_of(IN(Case) c) {
    Texture map = c.map;
    map.depth = map.height;  // as many slices of one row
    map.height = 1u;
    return map;
}
// A ray through a box whose cells it crosses at a few places. Not along its planes.
inline BoxRay in_box(IN(Inputs) x) {
    return BoxRay(0.5f + 0.1f * x.wo, x.n + vec3(0.01f, 0.02f, 0.03f));
}
inline Body body_of(IN(Case) c, IN(Inputs) x) {
    return in_media(c).scene.bodies.items[x.d % BodyCount];
}
inline Span span_of(IN(Inputs) x) {
    return Span(x.wo, x.n, 0.1f + 4.0f * x.metallic);
}
inline SpanView view_of_span(IN(Inputs) x) {
    return view_span(span_of(x), vec2(0.0f, 0.1f + 3.0f * x.metallic), 2.0f * x.wi, 0.05f + x.roughness);
}
// Distances where a span ends are as far apart as the rounded angle.
inline SpanView span_from_emitter(IN(Case) c, IN(Inputs) x) {
    if (c.context.scene.tree_light_count == 0u) return view_of_span(x);
    return seen_from(c.context.scene, span_of(x), x.a % TriangleEmitters);
}
inline LegLight lit_leg(IN(Case) c, IN(Inputs) x) {
    Path path = c.path;
    path.inside = uvec4(x.d % 4u, NoInstance, NoInstance, NoInstance);
    return light_leg(in_media(c), path, Ray(x.wo, x.n), new_course(x.wo), 0.1f + x.metallic, x.c % 3u);
}
inline LegShares shares_of(IN(Case) c, IN(Inputs) x) {
    LegLight leg = no_leg_light();
    leg.is_on = c.context.scene.tree_light_count > 0u;
    leg.is_aside = x.b % 2u == 0u;
    leg.span = span_of(x);
    leg.distance = x.u.x * leg.span.extent;
    leg.pdf = x.pdf;
    leg.density = x.metallic;
    LightSample light = no_light();
    light.emitter = int(x.a % TriangleEmitters);
    light.chance = 0.3f;
    return leg_shares(c.context.scene, StrategyBoth + (x.c % 2u) * StrategyEquiangularOnly, leg, light,
                      c.receiver);
}
inline BoxRay through_box(IN(Case) c, IN(Inputs) x) {
    const BoxRay ray = box_ray(c.instance, body_of(c, x), c.instance.translation + c.instance.linear * x.wo,
                               c.instance.linear * x.n);
    return BoxRay(4.0f + ray.origin, 4.0f + ray.direction);
}
inline LegQuestion question_of(IN(Inputs) x) {
    LegQuestion question = ask_leg(x.c % 3u, x.color + 0.01f, vec2(x.u.x, x.v.x), x.v.y);
    if (x.a % 2u == 0u) question.aside = 0.5f * x.metallic;
    return question;
}
inline vec3 weights_of(IN(Inputs) x) {
    const LegQuestion question = question_of(x);
    return question.weights + vec3(question.u, question.place) + float(question.channel);
}
inline Body even_body(IN(Inputs) x) {
    Body body;
    body.absorption = x.light;
    body.scattering = x.color + 0.01f;
    body.emission = x.light;
    return body;
}
inline Leg even_leg(IN(Inputs) x) {
    return leg_through_even(even_body(x), 0.1f + x.metallic, question_of(x));
}
inline Leg cell_leg(IN(Case) c, IN(Inputs) x) {
    return leg_through_cells(in_media(c).scene, body_of(c, x), in_box(x), 0.1f + x.metallic, question_of(x));
}
inline Leg asked_leg(IN(Case) c, IN(Inputs) x) {
    Path path = c.path;
    path.inside = uvec4(x.d % 4u, NoInstance, NoInstance, NoInstance);
    return leg_of(in_media(c), path, Ray(x.wo, x.n), new_course(x.wo), 0.1f + x.metallic, x.c % 3u,
                  x.a % 2u == 0u ? 0.5f * x.metallic : -1.0f);
}
inline Surface medium_here(IN(Inputs) x) {
    return scattering_place(x.wo, x.n, x.x, x.d, 0.0f);
}
inline uvec4 gone_through(IN(Case) c, IN(Inputs) x) {
    uvec4 inside = nowhere();
    Course course = new_course(x.wo);
    course.skip = Skip(0u, 0.0f, x.c % 2u == 0u ? 1e30f : 0.0f);
    Hit hit = c.hit;
    hit.instance = hit.instance % 4u;
    go_through(in_media(c).scene, course, inside, hit, c.ray, 0.0f);
    come_through(in_media(c).scene, course, inside,
                 x.d % 3u == 0u && !is_open(in_media(c).scene, hit.instance), hit);
    return uvec4(inside.x, inside.y, course.skip.instance, course.enters ? 1u : 0u);
}
// Light that is found behind open bodies, and the path that goes on then.
inline Step connected(IN(Case) c, IN(Inputs) x) {
    Step step = first_step(c);
    Connection connection = no_connection();
    connection.light = x.light;
    connection.intensity = x.color;
    connection.way = c.way;
    connection.resume = Ray(x.wi, x.n);
    connection.inside = uvec4(x.a % 7u, NoInstance, NoInstance, NoInstance);
    step.goes_on = look_for_light(connection, step.path, step.ray, x.c % 2u == 0u);
    receive_light(c.context, step.path.found, connection.light, connection.intensity, connection.way,
                  step.ray.direction);
    if (x.d % 2u == 0u) step.goes_on = go_on_with_path(connection, step.path, step.ray);
    return step;
}
inline Branch rest_of(IN(Case) c) {
    BranchStack open;
    open.count = 0u;
    push_rest(open, c.branch, c.path, c.ray, new_course(c.ray.origin), true);
    return open.branches[0];
}

SHADING_END

#endif
