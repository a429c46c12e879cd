#ifndef TESSERA_TESTS_SHADING_SCENE_PUTS_H
#define TESSERA_TESTS_SHADING_SCENE_PUTS_H

#include "tests/shading/media_cases.h"

// Collects the members of the records that functions of a scene return.
SHADING_BEGIN

inline void put(INOUT(Outputs) y, IN(Ray) ray) {
    put(y, ray.origin);
    put(y, ray.direction);
}
inline void put(INOUT(Outputs) y, IN(RayCone) cone) {
    put(y, cone.width);
    put(y, cone.spread);
}
inline void put(INOUT(Outputs) y, IN(KeyInterval) interval) {
    put(y, interval.index);
    put(y, interval.fraction);
}
inline void put(INOUT(Outputs) y, IN(Affine3x4) place) {
    put(y, place.linear);
    put(y, place.translation);
}
inline void put(INOUT(Outputs) y, IN(SpecularChain) chain) {
    put(y, chain.is_single_channel);
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
inline void put(INOUT(Outputs) y, IN(DirectionAndDistance) offset) {
    put(y, offset.direction);
    put(y, offset.distance);
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
    if ((surface.bsdf.lobes & FeatureSurfaceShader) != 0u) {
        put(y, surface.bsdf.surface_shader);
    } else {
        put(y, surface.bsdf.diffuse);
        put(y, surface.bsdf.f0);
        put(y, surface.bsdf.alpha);
        put(y, surface.bsdf.multiscatter);
        put(y, vec3(surface.bsdf.base_multiscatter, surface.bsdf.multiscatter_out, surface.bsdf.base_out));
        put(y, vec3(surface.bsdf.coat_out, surface.bsdf.sheen_out, 1.0f));
        put(y, surface.bsdf.chances);
    }
    put(y, surface.bsdf.reflectance);
    put(y, surface.specular);
    put(y, surface.rough_fraction);
    put(y, surface.object);
    put(y, surface.triangle);
    put(y, surface.light);
    put(y, surface.scatters);
    put(y, surface.is_thin_wall);
}
inline void put(INOUT(Outputs) y, IN(ChildProbabilities) probabilities) {
    put(y, probabilities.first);
    put(y, probabilities.count);
    for (uint i = 0u; i < probabilities.count; ++i) put(y, probabilities.items[i]);
}
inline void put(INOUT(Outputs) y, IN(SphereView) seen) {
    put(y, seen.axis);
    put(y, seen.distance);
    put(y, seen.is_inside);
    put(y, seen.one_minus_cos_half_angle);
}
// Angles, offset by the size of the angles that they are differences of.
inline void put(INOUT(Outputs) y, IN(QuadView) seen) {
    put(y, vec3(seen.low, 1.0f));
    put(y, vec3(seen.high, 1.0f));
    put(y, 1.0f + seen.z);
    put(y, seen.unit);
    put(y, 4.0f + seen.solid_angle);
    put(y, 4.0f + seen.before);
}
inline void put(INOUT(Outputs) y, IN(TriangleView) seen) {
    put(y, 4.0f + seen.solid_angle);
    if (!is_by_solid_angle(seen)) return;
    put(y, 1.0f + seen.determinant);
    put(y, seen.to_p);
    put(y, seen.to_q);
    put(y, seen.to_r);
}
inline void put(INOUT(Outputs) y, IN(LightHit) hit) {
    put(y, hit.is_hit);
    put(y, vec3(hit.distance, 1.0f, 0.0f));  // points are of about that size
    put(y, hit.pdf);
}
inline void put(INOUT(Outputs) y, IN(ChosenEmitter) chosen) {
    put(y, chosen.index);
    put(y, chosen.probability);
}
inline void put(INOUT(Outputs) y, IN(LightChances) chances) {
    put(y, chances.tree);
    put(y, chances.weight);
    put(y, chances.least);
}
inline void put(INOUT(Outputs) y, IN(ChosenLight) chosen) {
    put(y, chosen.index);
    put(y, chosen.probability);
    put(y, 1.0f + chosen.rest);
}
inline void put(INOUT(Outputs) y, IN(LightSample) light) {
    put(y, light.intensity);
    put_next(y, light.radiance);
    // Its contribution. The density of a light seen edge-on is unbounded.
    put_next(y, light.pdf > 0.0f ? light.radiance / light.pdf : vec3(0.0f));
    put(y, light.direction);
    put(y, light.delta);
    put(y, light.distant);
    put(y, light.target);
    put(y, light.emitter);
    put(y, light.chance);
}
inline void put(INOUT(Outputs) y, IN(PathClassInfo) class_info) {
    put(y, class_info.scatter_count);
    put(y, class_info.last_is_delta);
    put(y, class_info.diffuse_fraction);
}
inline void put(INOUT(Outputs) y, IN(PathSample) found) {
    put(y, found.low);
    put_next(y, found.high);  // parts of one light
    put_next(y, found.diffuse);
    put(y, found.connections);
    put(y, found.albedo);
    put(y, found.normal);
    put(y, found.headlight);
    put(y, found.depth);
    put(y, found.object);
    put(y, found.alpha);
}
inline void put(INOUT(Outputs) y, IN(Path) path) {
    put(y, path.numbers);
    put(y, path.vertex);
    put(y, path.walls);
    put(y, path.speculars);
    put(y, path.throughput);
    put(y, path.probability);
    put(y, path.bsdf_pdf);
    put(y, path.last_position);
    put(y, path.last_normal);
    put(y, path.last_sky_cell);
    put(y, path.cone);
    put(y, path.chain);
    put(y, path.class_info);
    put(y, path.found);
    put(y, path.rays);
}
inline void put(INOUT(Outputs) y, IN(LobeChances) chances) {
    put(y, vec3(chances.reflection, chances.refraction, chances.rough));
}
inline void put(INOUT(Outputs) y, IN(Lobe) lobe) {
    put(y, lobe.kind);
    put(y, lobe.direction);
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
inline void put(INOUT(Outputs) y, IN(BranchStack) stack) {
    put(y, stack.count);
    put(y, stack.branches[0]);
    put(y, stack.branches[1]);
}
inline void put(INOUT(Outputs) y, uvec4 v) {
    put(y, v.x);
    put(y, v.y);
    put(y, v.z);
    put(y, v.w);
}
inline void put(INOUT(Outputs) y, IN(Skip) skip) {
    put(y, skip.instance);
    put(y, vec3(skip.near, skip.far, skip.unlit ? 1.0f : 0.0f));
}
inline void put(INOUT(Outputs) y, IN(ThinWalls) walls) {
    put(y, walls.count);
    put(y, walls.first.triangle);
    put(y, walls.second.triangle);
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
// Weights divided by densities, of any size.
inline void put(INOUT(Outputs) y, IN(PathSegment) segment) {
    put(y, segment.passed);
    put(y, segment.emitted);
    put(y, segment.scattered);
    put(y, vec3(segment.distance, 1.0f, 0.0f));
    put(y, segment.scatters);
    put(y, segment.anisotropy);
    put(y, segment.equiangular);
    put(y, vec3(segment.density, segment.equiangular_density, 1.0f));
}
inline void put(INOUT(Outputs) y, IN(SpanView) seen) {
    put(y, vec3(seen.near, seen.extent, 1.0f));
    put(y, vec3(seen.foot, seen.height, 1.0f));
    put(y, 1.0f + seen.angle);
}
inline void put(INOUT(Outputs) y, IN(EquiangularSample) segment) {
    put(y, segment.is_active);
    put(y, segment.is_equiangular);
    put(y, segment.chosen.index);
    put(y, segment.chosen.probability);
    put(y, vec3(segment.distance, 1.0f, 0.0f));
    put(y, segment.pdf);
}
inline void put(INOUT(Outputs) y, IN(EquiangularWeights) weights) {
    put(y, 1.0f + weights.weight);
    put(y, weights.other_probability);
}
inline void put(INOUT(Outputs) y, IN(Connection) connection) {
    put(y, connection.is_open);
    put(y, connection.light);
}
inline void put(INOUT(Outputs) y, IN(MediumTraversal) traversal) {
    put(y, traversal.skip);
    put(y, traversal.enters);
    put(y, traversal.segment_distance);
    put(y, traversal.segment_start);
}
inline void put(INOUT(Outputs) y, IN(Sink) values) {
    put(y, vec3(values.sums, 1.0f));
    put(y, values.infinite);
    put(y, values.count);
}

SHADING_END

#endif
