#ifndef TESSERA_TESTS_SHADING_WORLD_PUTS_H
#define TESSERA_TESTS_SHADING_WORLD_PUTS_H

#include "tests/shading/media_cases.h"

// Where the members of records go that functions of a scene return.
SHADING_BEGIN

inline void put(INOUT(Outputs) y, IN(Ray) ray) {
    put(y, ray.origin);
    put(y, ray.direction);
}
inline void put(INOUT(Outputs) y, IN(Cone) cone) {
    put(y, cone.width);
    put(y, cone.spread);
}
inline void put(INOUT(Outputs) y, IN(Moment) moment) {
    put(y, moment.step);
    put(y, moment.share);
}
inline void put(INOUT(Outputs) y, IN(Place) place) {
    put(y, place.linear);
    put(y, place.translation);
}
inline void put(INOUT(Outputs) y, IN(Chain) chain) {
    put(y, chain.has_one_channel);
    put(y, chain.environment);
}
inline void put(INOUT(Outputs) y, IN(TexSteps) steps) {
    put(y, vec3(steps.p, 1.0f));
    put(y, vec3(steps.q, 1.0f));
}
inline void put(INOUT(Outputs) y, IN(EdgesInWorld) edges) {
    put(y, edges.p);
    put(y, edges.q);
    put(y, edges.scale);
}
inline void put(INOUT(Outputs) y, IN(Measured) measured) {
    put(y, measured.direction);
    put(y, measured.distance);
}
inline void put(INOUT(Outputs) y, IN(Choice) choice) {
    put(y, choice.index);
    put(y, choice.rest);
}
inline void put(INOUT(Outputs) y, IN(PointWithError) point) {
    put(y, point.position);
    put(y, point.error);
}
inline void put(INOUT(Outputs) y, IN(Sky) sky) {
    put(y, sky.radiance);
    put(y, sky.pdf);
}
inline void put(INOUT(Outputs) y, IN(Triangle) triangle) {
    put(y, triangle.p);
    put(y, triangle.q);
    put(y, triangle.r);
}
inline void put(INOUT(Outputs) y, IN(Surface) surface) {
    put(y, surface.position);
    put(y, surface.error);
    put(y, surface.geometric_normal);
    put(y, surface.frame);
    put(y, surface.albedo);
    put(y, surface.emission);
    put(y, surface.bsdf.lobes);
    if ((surface.bsdf.lobes & FeatureShader) != 0u) {
        put(y, surface.bsdf.shader);
    } else {
        put(y, surface.bsdf.diffuse);
        put(y, surface.bsdf.f0);
        put(y, surface.bsdf.alpha);
        put(y, surface.bsdf.late);
        put(y, vec3(surface.bsdf.base_late, surface.bsdf.late_out, surface.bsdf.base_out));
        put(y, vec3(surface.bsdf.coat_out, surface.bsdf.sheen_out, 1.0f));
        put(y, surface.bsdf.chances);
    }
    put(y, surface.bsdf.reflectance);
    put(y, surface.specular);
    put(y, surface.rough_share);
    put(y, surface.object);
    put(y, surface.triangle);
    put(y, surface.light);
    put(y, surface.scatters);
}
inline void put(INOUT(Outputs) y, IN(ChildShares) shares) {
    put(y, shares.first);
    put(y, shares.count);
    for (uint i = 0u; i < shares.count; ++i) put(y, shares.items[i]);
}
inline void put(INOUT(Outputs) y, IN(SphereView) seen) {
    put(y, seen.axis);
    put(y, seen.distance);
    put(y, seen.is_inside);
    put(y, seen.cap);
}
// Angles beside those that they are differences of.
inline void put(INOUT(Outputs) y, IN(QuadView) seen) {
    put(y, vec3(seen.low, 1.0f));
    put(y, vec3(seen.high, 1.0f));
    put(y, 1.0f + seen.z);
    put(y, seen.unit);
    put(y, 4.0f + seen.solid_angle);
    put(y, 4.0f + seen.before);
}
inline void put(INOUT(Outputs) y, IN(ShapeHit) hit) {
    put(y, hit.is_hit);
    put(y, vec3(hit.distance, 1.0f, 0.0f));  // of places of about that size
    put(y, hit.pdf);
}
inline void put(INOUT(Outputs) y, IN(ChosenEmitter) chosen) {
    put(y, chosen.index);
    put(y, chosen.probability);
}
inline void put(INOUT(Outputs) y, IN(LightSample) light) {
    put(y, light.intensity);
    put_next(y, light.radiance);
    // What it counts with. A light seen from its own plane has a density without bound.
    put_next(y, light.pdf > 0.0f ? light.radiance / light.pdf : vec3(0.0f));
    put(y, light.direction);
    put(y, light.delta);
    put(y, light.distant);
    put(y, light.target);
    put(y, light.emitter);
    put(y, light.chance);
}
inline void put(INOUT(Outputs) y, IN(Way) way) {
    put(y, way.scatterings);
    put(y, way.last_is_delta);
    put(y, way.diffuse_share);
}
inline void put(INOUT(Outputs) y, IN(PathSample) found) {
    put(y, found.low);
    put_next(y, found.high);  // parts of one light
    put_next(y, found.diffuse);
    put(y, found.connections);
    put(y, found.albedo);
    put(y, found.normal);
    put(y, found.range);
    put(y, found.depth);
    put(y, found.object);
    put(y, found.alpha);
}
inline void put(INOUT(Outputs) y, IN(Path) path) {
    put(y, path.numbers);
    put(y, path.vertex);
    put(y, path.throughput);
    put(y, path.probability);
    put(y, path.bsdf_pdf);
    put(y, path.last_position);
    put(y, path.last_normal);
    put(y, path.cone);
    put(y, path.chain);
    put(y, path.way);
    put(y, path.found);
    put(y, path.rays);
}
inline void put(INOUT(Outputs) y, IN(LobeChances) chances) {
    put(y, vec3(chances.reflection, chances.refraction, chances.rough));
}
inline void put(INOUT(Outputs) y, IN(Lobe) lobe) {
    put(y, lobe.kind);
    put(y, vec3(1.0f, lobe.choice, lobe.roulette));  // numbers of [0, 1), so their ulp is that of 1
}
inline void put(INOUT(Outputs) y, IN(Step) step) {
    put(y, step.path);
    put(y, step.lobe);
    put(y, step.ray);
    put(y, step.goes_on);
}
inline void put(INOUT(Outputs) y, IN(Branch) branch) {
    put(y, branch.ray);
    put(y, branch.cone);
    put(y, branch.weight);
    put(y, branch.probability);
    put(y, branch.node);
    put(y, branch.depth);
    put(y, branch.chain);
}
inline void put(INOUT(Outputs) y, IN(BranchStack) open) {
    put(y, open.count);
    put(y, open.branches[0]);
    put(y, open.branches[1]);
}
inline void put(INOUT(Outputs) y, uvec4 v) {
    put(y, v.x);
    put(y, v.y);
    put(y, v.z);
    put(y, v.w);
}
inline void put(INOUT(Outputs) y, IN(Skip) skip) {
    put(y, skip.instance);
    put(y, vec3(skip.near, skip.far, 1.0f));
}
inline void put(INOUT(Outputs) y, IN(Boundary) boundary) {
    put(y, boundary.position);
    put(y, boundary.error);
    put(y, boundary.normal);
    put(y, boundary.enters);
}
inline void put(INOUT(Outputs) y, IN(BoxRay) ray) {
    put(y, ray.origin);
    put(y, ray.direction);
}
inline void put(INOUT(Outputs) y, IN(Coefficients) coefficients) {
    put(y, coefficients.extinction);
    put(y, coefficients.scattering);
}
// Shares divided by densities, so that they may be of any size.
inline void put(INOUT(Outputs) y, IN(Leg) leg) {
    put(y, leg.passed);
    put(y, leg.emitted);
    put(y, leg.scattered);
    put(y, vec3(leg.distance, 1.0f, 0.0f));
    put(y, leg.scatters);
    put(y, leg.anisotropy);
    put(y, leg.aside);
    put(y, vec3(leg.density, leg.aside_density, 1.0f));
}
inline void put(INOUT(Outputs) y, IN(SpanView) seen) {
    put(y, vec3(seen.near, seen.extent, 1.0f));
    put(y, vec3(seen.foot, seen.height, 1.0f));
    put(y, 1.0f + seen.angle);
}
inline void put(INOUT(Outputs) y, IN(LegLight) leg) {
    put(y, leg.is_on);
    put(y, leg.is_aside);
    put(y, leg.chosen.index);
    put(y, leg.chosen.probability);
    put(y, vec3(leg.distance, 1.0f, 0.0f));
    put(y, leg.pdf);
}
inline void put(INOUT(Outputs) y, IN(LegShares) shares) {
    put(y, 1.0f + shares.share);
    put(y, shares.other_chance);
}
inline void put(INOUT(Outputs) y, IN(Connection) connection) {
    put(y, connection.is_open);
    put(y, connection.light);
}
inline void put(INOUT(Outputs) y, IN(Course) course) {
    put(y, course.skip);
    put(y, course.enters);
    put(y, course.begun);
    put(y, course.start);
}
inline void put(INOUT(Outputs) y, IN(Sink) values) {
    put(y, vec3(values.sums, 1.0f));
    put(y, values.infinite);
    put(y, values.count);
}

SHADING_END

#endif
