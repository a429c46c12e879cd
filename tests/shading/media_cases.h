#ifndef TESSERA_TESTS_SHADING_MEDIA_CASES_H
#define TESSERA_TESTS_SHADING_MEDIA_CASES_H

#include "tests/shading/scene_cases.h"

// Arguments for functions of media: the same scene, with media.
SHADING_BEGIN

// The scene with media; without in the dark scene.
inline Context in_media(IN(Case) c) {
    Context context = c.context;
    if (context.scene.features != 0u) {
        context.scene.features = context.scene.features | FeatureMedia | FeatureIndexMatchedMedia |
                                 FeatureScattering | FeatureMediaTextures;
    }
    return context;
}
// Several media, sorted by priority.
inline uvec4 nested_media(IN(Case) c, IN(Inputs) x) {
    uvec4 containing_media = no_media();
    Scene scene = in_media(c).scene;
    for (uint i = 0u; i < x.a % 5u; ++i)
        containing_media = with_medium(scene, containing_media, (x.b + i) % 7u);
    return containing_media;
}
inline Texture volume_of(IN(Case) c) {
    Texture map = c.map;
    map.depth = map.height;  // as many slices of one row
    map.height = 1u;
    return map;
}
// A ray that crosses a few cells of a box, not along its planes.
inline BoxRay in_box(IN(Inputs) x) {
    return BoxRay(0.5f + 0.1f * x.wo, x.n + vec3(0.01f, 0.02f, 0.03f));
}
inline Medium medium_of(IN(Case) c, IN(Inputs) x) {
    return in_media(c).scene.media.items[x.d % MediumCount];
}
inline Span span_of(IN(Inputs) x) {
    return Span(x.wo, x.n, 0.1f + 4.0f * x.metallic);
}
inline SpanView view_of_span(IN(Inputs) x) {
    return view_span(span_of(x), vec2(0.0f, 0.1f + 3.0f * x.metallic), 2.0f * x.wi, 0.05f + x.roughness);
}
// Distances at the ends of a span differ by the rounding error of the angle.
inline SpanView span_from_emitter(IN(Case) c, IN(Inputs) x) {
    if (c.context.scene.tree_light_count == 0u) return view_of_span(x);
    return seen_from(c.context.scene, span_of(x), x.a % TriangleEmitters);
}
inline EquiangularSample equiangular_sample_of(IN(Case) c, IN(Inputs) x) {
    Path path = c.path;
    path.containing_media = uvec4(x.d % 4u, NoInstance, NoInstance, NoInstance);
    return sample_equiangular(in_media(c), path, Ray(x.wo, x.n), new_traversal(x.wo), 0.1f + x.metallic,
                              x.c % 3u);
}
inline EquiangularWeights equiangular_weights_of(IN(Case) c, IN(Inputs) x) {
    EquiangularSample equiangular = no_equiangular_sample();
    equiangular.is_active = c.context.scene.tree_light_count > 0u;
    equiangular.is_equiangular = x.b % 2u == 0u;
    equiangular.span = span_of(x);
    equiangular.distance = x.u.x * equiangular.span.extent;
    equiangular.pdf = x.pdf;
    equiangular.density = x.metallic;
    LightSample light = no_light();
    light.emitter = int(x.a % TriangleEmitters);
    light.chance = 0.3f;
    View view = c.context.view;
    view.strategy = StrategyBoth + (x.c % 2u) * StrategyEquiangularOnly;
    return equiangular_weights(c.context.scene, view, equiangular, light, c.receiver);
}
inline BoxRay through_box(IN(Case) c, IN(Inputs) x) {
    const BoxRay ray = box_ray(c.instance, medium_of(c, x), c.instance.translation + c.instance.linear * x.wo,
                               c.instance.linear * x.n);
    return BoxRay(4.0f + ray.origin, 4.0f + ray.direction);
}
inline SegmentQuery query_of(IN(Inputs) x) {
    SegmentQuery query = segment_query(x.c % 3u, x.color + 0.01f, vec2(x.u.x, x.v.x), x.v.y);
    if (x.a % 2u == 0u) query.equiangular_distance = 0.5f * x.metallic;
    return query;
}
inline vec3 weights_of(IN(Inputs) x) {
    const SegmentQuery query = query_of(x);
    return query.weights + vec3(query.u, query.emission_sample) + float(query.channel);
}
inline Medium homogeneous_medium(IN(Inputs) x) {
    Medium medium;
    medium.absorption = x.light;
    medium.scattering = x.color + 0.01f;
    medium.emission = x.light;
    return medium;
}
inline PathSegment homogeneous_segment(IN(Inputs) x) {
    return segment_through_homogeneous(homogeneous_medium(x), 0.1f + x.metallic, query_of(x));
}
inline PathSegment grid_segment(IN(Case) c, IN(Inputs) x) {
    return segment_through_grid(in_media(c).scene, medium_of(c, x), in_box(x), 0.1f + x.metallic,
                                query_of(x));
}
inline PathSegment traversed_segment(IN(Case) c, IN(Inputs) x) {
    Path path = c.path;
    path.containing_media = uvec4(x.d % 4u, NoInstance, NoInstance, NoInstance);
    return traverse_segment(in_media(c), path, Ray(x.wo, x.n), new_traversal(x.wo), 0.1f + x.metallic,
                            x.c % 3u, x.a % 2u == 0u ? 0.5f * x.metallic : -1.0f);
}
inline Surface medium_here(IN(Inputs) x) {
    return scattering_place(x.wo, x.n, x.x, x.d, 0.0f);
}
inline uvec4 crossed_boundary(IN(Case) c, IN(Inputs) x) {
    uvec4 containing_media = no_media();
    MediumTraversal traversal = new_traversal(x.wo);
    traversal.skip = Skip(0u, 0.0f, x.c % 2u == 0u ? 1e30f : 0.0f, false);
    Hit hit = c.hit;
    hit.instance = hit.instance % 4u;
    cross_boundary(in_media(c).scene, traversal, containing_media, hit, c.ray, 0.0f);
    finish_crossing(in_media(c).scene, traversal, containing_media,
                    x.d % 3u == 0u && !is_index_matched(in_media(c).scene, hit.instance), hit);
    return uvec4(containing_media.x, containing_media.y, traversal.skip.instance, traversal.enters ? 1u : 0u);
}
// A connection through index-matched media, and the path that continues afterwards.
inline Step connection_step(IN(Case) c, IN(Inputs) x) {
    Step step = first_step(c);
    Connection connection = no_connection();
    connection.light = x.light;
    connection.intensity = x.color;
    connection.class_info = c.class_info;
    connection.resume = Ray(x.wi, x.n);
    connection.containing_media = uvec4(x.a % 7u, NoInstance, NoInstance, NoInstance);
    step.goes_on = start_connection(connection, step.path, step.ray, x.c % 2u == 0u);
    receive_light(c.context, step.path.found, connection.light, connection.intensity, connection.class_info,
                  step.ray.direction);
    if (x.d % 2u == 0u) step.goes_on = resume_path(connection, step.path, step.ray);
    return step;
}
inline Branch rest_branch(IN(Case) c) {
    BranchStack stack;
    stack.count = 0u;
    push_rest(stack, c.branch, c.path, c.ray, new_traversal(c.ray.origin), true);
    return stack.branches[0];
}

SHADING_END

#endif
