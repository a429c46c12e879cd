#ifndef TESSERA_MEDIATOR_SHADING_RAY_CONES_H
#define TESSERA_MEDIATOR_SHADING_RAY_CONES_H

#include "mediator/shading/maths.h"
#include "mediator/shading/triangle_points.h"

// Footprints of paths, for the filtering of colours only (ray cones: Akenine-Moeller et al. 2021). The width
// of sample i is that of the whole pixel divided by sqrt(i + 1): first samples see prefiltered colours, and
// the mean of many samples still converges to that of point samples. Until then the film is biased: sample i
// is blurred over its footprint, so that at an edge the mean of N samples is off by at most the contrast times
// the mean of 1 / (2 sqrt(i + 1)), which is less than 1 / sqrt(N). Whatever light does not depend on linearly
// is looked up at points (Material::filters_color), since blurring it would bias whole surfaces.
SHADING_BEGIN

struct RayCone {
    float width;   // in the world, across the ray
    float spread;  // increase of the width per unit of distance
};

// Scale of the footprint of the sample with this index, from 0.
inline float footprint_scale(uint index) {
    return inverse_sqrt(float(index) + 1.0f);
}

// Of a pixel, through a pinhole or a point of a lens: its solid angle is step.x step.y cos^3.
inline RayCone camera_cone(IN(View) view, IN(Ray) ray, uint index) {
    if ((view.camera & CameraOrthographic) != 0u)
        return RayCone(footprint_scale(index) * sqrt(abs(view.step.x * view.step.y)), 0.0f);
    const float cosine = greater_of(dot(ray.direction, view.forward), 0.0f);
    const float solid_angle = abs(view.step.x * view.step.y) * cosine * cosine * cosine;
    return RayCone(0.0f, footprint_scale(index) * sqrt(solid_angle));
}

// Spread after sampling a direction with this density, which represents a solid angle of 1 / pdf; at most one
// radian.
inline float chosen_spread(float pdf, uint index) {
    return footprint_scale(index) * lesser_of(inverse_sqrt(greater_of(pdf, 1e-30f)), 1.0f);
}

// Area of a triangle that a path of this width covers, as a fraction of the parallelogram over two of its
// edges. `cosine`: of direction and normal, at least 0. Returns 0 if nothing is textured.
inline float triangle_footprint(IN(Scene) scene, IN(Instance) instance, IN(Triangle) t, float cosine,
                                float width) {
    if ((scene.features & FeatureTextures) == 0u || !(width > 0.0f)) return 0.0f;
    const vec3 across = cross(instance.linear * (t.q - t.p), instance.linear * (t.r - t.p));
    return width * width / greater_of(vector_length(across) * cosine, 1e-30f);
}

SHADING_END

#endif
