#ifndef TESSERA_MEDIATOR_SHADING_EQUIANGULAR_H
#define TESSERA_MEDIATOR_SHADING_EQUIANGULAR_H

#include "mediator/shading/lights.h"

// Places of a leg in a medium where much light arrives: even in the angle under which the leg is seen from a
// light, so that 1 / distance^2 cancels (Kulla and Fajardo 2012). One such place for each leg, with a light
// of its own, beside the place that free flight finds by chance: both find light in all places of a leg that
// a light shines on, and are combined by the balance heuristic (Veach 1997) over places and lights. Free
// flight goes on as it would: what is behind the fog loses no samples to it.
SHADING_BEGIN

// A straight part of a ray.
struct Span {
    vec3 start;
    vec3 direction;  // unit length
    float extent;    // metres
};

// The part of a span that a light may shine on, as seen from the light.
struct SpanView {
    float near;  // where it begins on the span; in metres, as all here
    float extent;
    float foot;  // from there to the foot of the light's height over the span, which may lie beyond both ends
    float height;  // more than 0
    float angle;   // that the part spans; 0: no light comes there
};

// Where a light's own cone or front meets the span; `cosine` of its half angle, at least 0. x: where that
// begins, y: where it ends, no more than x: nowhere.
inline vec2 lit_part(IN(Span) span, vec3 apex, vec3 axis, float cosine) {
    const vec3 from = span.start - apex;
    const float b = dot(from, axis), rise = dot(span.direction, axis), cosine2 = cosine * cosine;
    // Of f(t) = (height over the apex)^2 - (cosine x distance)^2, positive in both halves of the cone.
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

// One that moves may shine on all of it.
inline vec2 part_lit_by(IN(Span) span, IN(LightSource) light) {
    if (light.motion < 0 && light.kind == LightSpot && light.cos_outer > 0.0f) {
        return lit_part(span, light.position, light.direction, light.cos_outer);
    }
    if (light.motion < 0 && light.kind == LightQuad)
        return lit_part(span, light.position, light.direction, 0.0f);
    return vec2(0.0f, span.extent);
}

// `radius`: of the light's ball; places within it count as if they were at its rim. Nor is a light nearer
// than rounding can tell.
inline SpanView view_span(IN(Span) span, vec2 part, vec3 middle, float radius) {
    SpanView seen = SpanView(part.x, part.y - part.x, 0.0f, 1.0f, 0.0f);
    const vec3 offset = middle - span.start;
    const float unit = greater_of(extent_of(offset), span.extent);
    if (!(seen.extent > 0.0f) || !(unit > 0.0f) || !is_finite(unit)) return seen;
    const vec3 scaled = offset / unit;
    const float along = dot(scaled, span.direction);
    const vec3 across = scaled - along * span.direction;
    const float size = radius / unit, least = rounding_bound(8.0f);
    const float height = sqrt(dot(across, across) + size * size + least * least);
    const float to_start = part.x / unit - along, to_end = part.y / unit - along;
    seen.angle = arc_tangent((to_end - to_start) * height, height * height + to_start * to_end);
    seen.foot = -to_start * unit;
    seen.height = height * unit;
    return seen;
}

// On the span. By the triangle of light, beginning and place, whose angle at the light is known: it does not
// cancel where the part is seen under a small one.
inline float equiangular_distance(IN(SpanView) seen, float u) {
    const float angle = u * seen.angle;
    const float foot = seen.foot / seen.height;
    const float across = sine(angle);
    const float opening = foot * across + cosine(angle);
    const float distance = (1.0f + foot * foot) * across / opening * seen.height;
    // Rounded beyond its end.
    if (!(opening > 0.0f)) return seen.near + seen.extent;
    return seen.near + clamp(distance, 0.0f, seen.extent);
}

// Per metre.
inline float equiangular_pdf(IN(SpanView) seen, float distance) {
    const float beyond = distance - seen.near;
    if (!(seen.angle > 0.0f) || beyond < 0.0f || beyond > seen.extent) return 0.0f;
    const float ratio = (beyond - seen.foot) / seen.height;
    return 1.0f / (seen.angle * seen.height * (1.0f + ratio * ratio));
}

// What is known of a leg where light is looked for at one of its places.
struct LegLight {
    bool is_on;     // there are two such places
    bool is_aside;  // it is that beside the path; else it is the path's own
    Span span;
    ChosenEmitter chosen;  // for the place aside
    float distance;        // of the place
    float pdf;             // per metre, of the place aside
    float density;         // per metre, with which free flight scatters there
};

inline LegLight no_leg_light() {
    return LegLight(false, false, Span(vec3(0.0f), vec3(0.0f), 0.0f), no_emitter(), 0.0f, 0.0f, 0.0f);
}

// For the place that free flight has found, which it does with `density`.
inline LegLight at_own_place(IN(LegLight) leg, float distance, float density) {
    LegLight own = leg;
    own.is_aside = false;
    own.distance = distance;
    own.density = density;
    return own;
}

// Light is welcome all along.
inline Receiver receiver_along(IN(Span) span) {
    return Receiver(span.start, vec3(0.0f), span.extent * span.direction);
}

inline SpanView seen_from(IN(Scene) scene, IN(Span) span, uint emitter) {
    const Emitter light = scene.emitters.items[emitter];
    const LightNode node = scene.light_nodes.items[light.node];
    return view_span(span, part_lit_by(span, scene.lights.items[light.light]), node.middle, node.radius);
}

// Shares of light that is found in both ways; `other_chance`: of the light, with which the other way would
// have chosen it.
struct LegShares {
    float share;
    float other_chance;
};
inline LegShares leg_shares(IN(Scene) scene, uint strategy, IN(LegLight) leg, IN(LightSample) light,
                            IN(Receiver) place) {
    LegShares shares = LegShares(1.0f, light.chance);
    if (!leg.is_on || light.emitter < 0) return shares;
    const uint emitter = uint(light.emitter);
    const uint node = scene.emitters.items[emitter].node;
    Receiver other = receiver_along(leg.span);
    if (leg.is_aside) other = place;
    shares.other_chance = leaf_probability(scene, node, other);
    if (leg.is_aside) shares.other_chance *= scene.tree_probability;
    float aside = leg.pdf * light.chance, flight = leg.density * shares.other_chance;
    if (!leg.is_aside) {
        aside = equiangular_pdf(seen_from(scene, leg.span, emitter), leg.distance) * shares.other_chance;
        flight = leg.density * light.chance;
    }
    if (strategy == StrategyEquiangularOnly) flight = 0.0f;
    const float own = leg.is_aside ? aside : flight;
    shares.share = own > 0.0f ? own / (aside + flight) : 0.0f;
    return shares;
}

SHADING_END

#endif
