#ifndef TESSERA_MEDIATOR_SHADING_EQUIANGULAR_H
#define TESSERA_MEDIATOR_SHADING_EQUIANGULAR_H

#include "mediator/shading/lights.h"

// Equiangular sampling (Kulla and Fajardo 2012): points of a segment in a medium, uniform in the angle seen
// from a light, so that 1 / distance^2 cancels. Each segment has one such sample, with its own light, in
// addition to the free flight sample. Both techniques can reach all points that a light illuminates, and are
// combined by the balance heuristic (Veach 1997) over points and lights. Free flight sampling is unaffected,
// so surfaces behind fog lose no samples to it.
SHADING_BEGIN

// A straight part of a ray.
struct Span {
    vec3 start;
    vec3 direction;  // unit length
    float extent;    // metres
};

// The part of a span that a light may illuminate, as seen from the light.
struct SpanView {
    float near;  // its start on the span; all lengths in metres
    float extent;
    float foot;    // from the start to the light's projection on the span, which may lie outside of it
    float height;  // distance of the light from the span's line; more than 0
    float angle;   // subtended by the part; 0: not illuminated
};

// The interval x to y of the span inside a light's cone or half space; `cosine` of its half angle, at least
// 0. Empty if y <= x.
inline vec2 lit_part(IN(Span) span, vec3 apex, vec3 axis, float cosine) {
    const vec3 from = span.start - apex;
    const float b = dot(from, axis), rise = dot(span.direction, axis), cosine2 = cosine * cosine;
    // Coefficients of f(t) = (height over the apex)^2 - (cosine x distance)^2, positive in both halves of the
    // cone.
    const float a = rise * rise - cosine2;
    const float half_b = b * rise - cosine2 * dot(from, span.direction);
    const float c = b * b - cosine2 * dot(from, from);
    const vec2 all = vec2(0.0f, span.extent);
    if (abs(a) < 1e-6f) return all;
    const float square = half_b * half_b - a * c;
    if (square < 0.0f && a < 0.0f) return vec2(0.0f);
    const float root = sqrt(greater_of(square, 0.0f));
    const float q = half_b < 0.0f ? root - half_b : -half_b - root;
    if (q == 0.0f) return all;
    const float first = q / a, second = c / q;
    const float low = lesser_of(first, second), high = greater_of(first, second);
    if (a > 0.0f) {
        return rise > 0.0f ? vec2(greater_of(high, 0.0f), span.extent)
                           : vec2(0.0f, lesser_of(low, span.extent));
    }
    const vec2 between = vec2(greater_of(low, 0.0f), lesser_of(high, span.extent));
    return b + 0.5f * (between.x + between.y) * rise > 0.0f ? between : vec2(0.0f);
}

// A moving light may illuminate all of it.
inline vec2 lit_part_of(IN(Span) span, IN(LightSource) light) {
    if (light.motion < 0 && light.kind == LightSpot && light.cos_outer > 0.0f) {
        return lit_part(span, light.position, light.direction, light.cos_outer);
    }
    if (light.motion < 0 && light.kind == LightQuad)
        return lit_part(span, light.position, light.direction, 0.0f);
    return vec2(0.0f, span.extent);
}

// `radius`: of the light's bounding sphere; closer points count as on the sphere. The distance is also at
// least that of the rounding error.
inline SpanView view_span(IN(Span) span, vec2 part, vec3 center, float radius) {
    SpanView span_view = SpanView(part.x, part.y - part.x, 0.0f, 1.0f, 0.0f);
    const vec3 offset = center - span.start;
    const float unit = greater_of(extent_of(offset), span.extent);
    if (!(span_view.extent > 0.0f) || !(unit > 0.0f) || !is_finite(unit)) return span_view;
    const vec3 scaled = offset / unit;
    const float along = dot(scaled, span.direction);
    const vec3 across = scaled - along * span.direction;
    const float size = radius / unit, least = rounding_bound(8.0f);
    const float height = sqrt(dot(across, across) + size * size + least * least);
    const float to_start = part.x / unit - along, to_end = part.y / unit - along;
    span_view.angle = arc_tangent((to_end - to_start) * height, height * height + to_start * to_end);
    span_view.foot = -to_start * unit;
    span_view.height = height * unit;
    return span_view;
}

// Distance on the span, by the triangle of light, start and point, whose angle at the light is known: no
// cancellation for small angles.
inline float equiangular_distance(IN(SpanView) span_view, float u) {
    const float angle = u * span_view.angle;
    const float foot = span_view.foot / span_view.height;
    const float across = sine(angle);
    const float opening = foot * across + cosine(angle);
    const float distance = (1.0f + foot * foot) * across / opening * span_view.height;
    // Rounding led beyond the end.
    if (!(opening > 0.0f)) return span_view.near + span_view.extent;
    return span_view.near + clamp(distance, 0.0f, span_view.extent);
}

// Per metre.
inline float equiangular_pdf(IN(SpanView) span_view, float distance) {
    const float beyond = distance - span_view.near;
    if (!(span_view.angle > 0.0f) || beyond < 0.0f || beyond > span_view.extent) return 0.0f;
    const float ratio = (beyond - span_view.foot) / span_view.height;
    return 1.0f / (span_view.angle * span_view.height * (1.0f + ratio * ratio));
}

// The equiangular sample of a segment, and what MIS with the free flight sample needs.
struct EquiangularSample {
    bool is_active;       // the segment has an equiangular sample: MIS applies
    bool is_equiangular;  // evaluated at the equiangular sample; else at the free flight sample
    Span span;
    ChosenEmitter chosen;  // light of the equiangular sample
    float distance;        // of the point
    float pdf;             // of the equiangular sample, per metre
    float density;         // of free flight sampling there, per metre
};

inline EquiangularSample no_equiangular_sample() {
    return EquiangularSample(false, false, Span(vec3(0.0f), vec3(0.0f), 0.0f), no_emitter(), 0.0f, 0.0f,
                             0.0f);
}

// The same for the free flight sample, which has this density.
inline EquiangularSample at_free_flight_point(IN(EquiangularSample) equiangular, float distance,
                                              float density) {
    EquiangularSample own = equiangular;
    own.is_equiangular = false;
    own.distance = distance;
    own.density = density;
    return own;
}

// A receiver along all of the span.
inline Receiver receiver_along(IN(Span) span) {
    return Receiver(span.start, vec3(0.0f), span.extent * span.direction, NoSkyCell);
}

inline SpanView seen_from(IN(Scene) scene, IN(Span) span, uint emitter) {
    const Emitter light = scene.emitters.items[emitter];
    const LightNode node = scene.light_nodes.items[light.node];
    return view_span(span, lit_part_of(span, scene.lights.items[light.light]), node.center, node.radius);
}

// Weight of a light sample among both techniques. `other_probability`: with which the other technique would
// have chosen this light.
struct EquiangularWeights {
    float weight;
    float other_probability;
};
inline EquiangularWeights equiangular_weights(IN(Scene) scene, IN(View) view,
                                              IN(EquiangularSample) equiangular, IN(LightSample) light,
                                              IN(Receiver) place) {
    EquiangularWeights weights = EquiangularWeights(1.0f, light.chance);
    if (!equiangular.is_active || light.emitter < 0) return weights;
    const uint emitter = uint(light.emitter);
    const uint node = scene.emitters.items[emitter].node;
    Receiver other = receiver_along(equiangular.span);
    if (equiangular.is_equiangular) other = place;
    weights.other_probability = leaf_probability(scene, node, other);
    if (equiangular.is_equiangular) weights.other_probability *= tree_chance(scene, view, place);
    float by_equiangular = equiangular.pdf * light.chance,
          by_flight = equiangular.density * weights.other_probability;
    if (!equiangular.is_equiangular) {
        by_equiangular = equiangular_pdf(seen_from(scene, equiangular.span, emitter), equiangular.distance) *
                         weights.other_probability;
        by_flight = equiangular.density * light.chance;
    }
    if (view.strategy == StrategyEquiangularOnly) by_flight = 0.0f;
    const float own = equiangular.is_equiangular ? by_equiangular : by_flight;
    weights.weight = own > 0.0f ? own / (by_equiangular + by_flight) : 0.0f;
    return weights;
}

SHADING_END

#endif
