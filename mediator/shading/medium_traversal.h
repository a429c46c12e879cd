#ifndef TESSERA_MEDIATOR_SHADING_MEDIUM_TRAVERSAL_H
#define TESSERA_MEDIATOR_SHADING_MEDIUM_TRAVERSAL_H

#include "mediator/shading/transport.h"

// Rays through media: segments between boundaries, and light sampling along them.
SHADING_BEGIN

// What a ray belongs to: the path; a branch of perfect speculars; a BSDF sample at the end of a branch, which
// gathers the light that it hits.
inline constexpr uint StagePath = 0u, StageBranch = 1u, StageGather = 2u;

// Progress of a ray through boundaries without a surface (trace.h).
struct MediumTraversal {
    Skip skip;               // the last boundary; it is crossed once the next hit of the ray is known
    bool enters;             // whether crossing it enters its medium
    float segment_distance;  // where the current segment starts, along the ray
    vec3 segment_start;      // the same point, more accurate than ray origin + distance
    uint segment_index;
};

inline MediumTraversal new_traversal(vec3 origin) {
    return MediumTraversal(skip_nothing(), false, 0.0f, origin, 0u);
}

// Paths scatter at random; branches of perfect speculars scatter once on each segment (single scattering). No
// scattering beyond the maximum path depth.
inline uint segment_kind(IN(Path) path, IN(View) view, uint stage, bool passes) {
    if (stage == StageBranch && !passes) return SegmentScatters;
    return stage == StagePath && may_scatter(path, view, false) ? SegmentMayScatter : SegmentTransmits;
}

// The equiangular sample uses a disjoint range of RNG dimensions: those of a vertex index that no path
// reaches.
inline uint equiangular_vertex(uint vertex, uint segment) {
    return vertex + 0x18000000u + (segment & 15u) * 0x00400000u;
}

// Chooses the equiangular sample of a segment that ends at `end`, if light is sampled there.
WITH_CONTEXT inline EquiangularSample sample_equiangular(IN(Context) context, IN(Path) path, IN(Ray) ray,
                                                         IN(MediumTraversal) traversal, float end,
                                                         uint kind) {
    EquiangularSample equiangular = no_equiangular_sample();
    if ((context.scene.features & FeatureScattering) == 0u || kind == SegmentTransmits) return equiangular;
    if (context.scene.tree_light_count == 0u || path.containing_media.x == NoInstance || !is_finite(end))
        return equiangular;
    if (context.view.strategy == StrategyFlightOnly) return equiangular;
    const int medium = context.scene.instances.items[path.containing_media.x].medium;
    if (!(largest(context.scene.media.items[medium].scattering) > 0.0f)) return equiangular;
    Path other_path = path;
    other_path.vertex = equiangular_vertex(path.vertex, traversal.segment_index);
    equiangular.is_active = true;
    equiangular.span =
        Span(traversal.segment_start, ray.direction, greater_of(end - traversal.segment_distance, 0.0f));
    equiangular.chosen = choose_emitter(context.scene, receiver_along(equiangular.span),
                                        first_pair(set_at(other_path, LightSet)));
    const SpanView span_view = seen_from(context.scene, equiangular.span, equiangular.chosen.index);
    equiangular.distance = equiangular_distance(span_view, first_pair(set_at(other_path, ScatterSet)).x);
    equiangular.pdf = equiangular_pdf(span_view, equiangular.distance);
    equiangular.is_equiangular = equiangular.pdf > 0.0f;
    return equiangular;
}

// The segment from its start to `end`, in multiples of the direction's length. `equiangular_at`: distance of
// the equiangular sample; less than 0: none.
WITH_CONTEXT inline PathSegment traverse_segment(IN(Context) context, IN(Path) path, IN(Ray) ray,
                                                 IN(MediumTraversal) traversal, float end, uint kind,
                                                 float equiangular_at) {
    if ((context.scene.features & FeatureMedia) == 0u || path.containing_media.x == NoInstance)
        return empty_segment();
    const float size = vector_length(ray.direction);
    const uint set = segment_set(path.vertex, traversal.segment_index);
    vec2 u = vec2(0.0f);
    if (kind != SegmentTransmits) u = sample_pair(path.numbers, set);
    const float place = unit_float(hash_combine(path.numbers.seed, set ^ path.numbers.index));
    SegmentQuery query = segment_query(kind, path.throughput, u, place);
    query.equiangular_distance = equiangular_at;
    return segment_through(context.scene, path.containing_media, traversal.segment_start,
                           ray.direction / size, greater_of(end - traversal.segment_distance, 0.0f) * size,
                           query, context.time);
}

// Continues a ray through a boundary without a surface. Surfaces that coincide with the boundary (within
// rounding) are still hit; in that case the boundary is not crossed.
inline void cross_boundary(IN(Scene) scene, INOUT(MediumTraversal) traversal, INOUT(uvec4) containing_media,
                           IN(Hit) hit, IN(Ray) ray, float time) {
    const Boundary boundary = boundary_at(scene, hit, ray.direction, time);
    const float tolerance =
        2.0f * dot(abs(boundary.normal), boundary.error) / abs(dot(boundary.normal, ray.direction)) +
        rounding_bound(16.0f) * hit.distance;
    const bool at_another = traversal.skip.instance != NoInstance && hit.distance <= traversal.skip.far;
    traversal.segment_distance = hit.distance;
    traversal.segment_start = boundary.position;
    traversal.segment_index += 1u;
    traversal.enters = boundary.enters;
    traversal.skip =
        Skip(hit.instance, greater_of(hit.distance - tolerance, NearestHit), hit.distance + tolerance, false);
    if (!at_another) return;
    // Two coincident boundaries would otherwise be hit alternately for ever.
    containing_media = after_crossing(scene, containing_media, hit.instance, boundary.enters);
    traversal.skip = Skip(NoInstance, hit.distance + tolerance, 0.0f, false);
}

// Completes the crossing once the next hit is known, and whether it is a surface.
inline void finish_crossing(IN(Scene) scene, IN(MediumTraversal) traversal, INOUT(uvec4) containing_media,
                            bool meets_surface, IN(Hit) hit) {
    if (traversal.skip.instance == NoInstance) return;
    if (!meets_surface || hit.distance > traversal.skip.far)
        containing_media = after_crossing(scene, containing_media, traversal.skip.instance, traversal.enters);
}

// The state of a ray, saved while the light at the equiangular sample of its segment is evaluated.
struct DeferredSegment {
    bool is_active;
    bool is_hit;
    Hit hit;
    PathSegment segment;
    EquiangularSample light;
    MediumTraversal traversal;
    vec3 throughput;
    uint vertex;
};

inline DeferredSegment no_deferred_segment() {
    return DeferredSegment(false, false, Hit(NoInstance, 0u, vec2(0.0f), 0.0f), empty_segment(),
                           no_equiangular_sample(), new_traversal(vec3(0.0f)), vec3(0.0f), 0u);
}

// Traces the connection first; the path's next ray is saved until the connection has ended.
inline bool start_connection(INOUT(Connection) connection, INOUT(Path) path, INOUT(Ray) ray, bool goes_on) {
    const Ray toward = connection.resume;
    const uvec4 containing_media = connection.containing_media;
    connection.resume = ray;
    connection.resumes = goes_on;
    connection.containing_media = path.containing_media;
    ray = toward;
    path.containing_media = containing_media;
    return true;
}
inline bool resume_path(INOUT(Connection) connection, INOUT(Path) path, INOUT(Ray) ray) {
    connection.is_open = false;
    ray = connection.resume;
    path.containing_media = connection.containing_media;
    return connection.resumes;
}

SHADING_END

#endif
