#ifndef TESSERA_MEDIATOR_SHADING_CONES_H
#define TESSERA_MEDIATOR_SHADING_CONES_H

#include "mediator/shading/maths.h"
#include "mediator/shading/points.h"

// How wide a path is, for textures alone (ray cones: Akenine-Moeller et al. 2021). Sample i stands for its
// share of the pixel: all widths are those of the whole pixel divided by sqrt(i + 1). So the first samples
// see no more detail than they can tell, and the mean of many still goes to what a point sees.
SHADING_BEGIN

struct Cone {
    float width;   // in the world, across the ray
    float spread;  // how much wider it gets on each unit of the way
};

// Of one sample out of so many, `index` from 0.
inline float share_of_sample(uint index) {
    return inverse_sqrt(float(index) + 1.0f);
}

// Of a pixel seen through a pinhole or a point of a lens: its solid angle is step.x step.y cos^3.
inline Cone camera_cone(IN(View) view, IN(Ray) ray, uint index) {
    if ((view.camera & CameraOrthographic) != 0u)
        return Cone(share_of_sample(index) * sqrt(abs(view.step.x * view.step.y)), 0.0f);
    const float cosine = greater_of(dot(ray.direction, view.forward), 0.0f);
    const float solid_angle = abs(view.step.x * view.step.y) * cosine * cosine * cosine;
    return Cone(0.0f, share_of_sample(index) * sqrt(solid_angle));
}

// What a direction that is chosen with this density stands for: a share 1 / pdf of all directions. No more
// than a radian: what is farther around is seen at other angles.
inline float chosen_spread(float pdf, uint index) {
    return share_of_sample(index) * lesser_of(inverse_sqrt(greater_of(pdf, 1e-30f)), 1.0f);
}

// What a path of this width covers of a triangle, as a share of the parallelogram over two of its edges.
// `cosine`: of its direction and the normal, at least 0. 0 where nothing is textured.
inline float triangle_footprint(IN(Scene) scene, IN(Instance) instance, IN(Triangle) t, float cosine,
                                float width) {
    if ((scene.features & FeatureTextures) == 0u || !(width > 0.0f)) return 0.0f;
    const vec3 across = cross(instance.linear * (t.q - t.p), instance.linear * (t.r - t.p));
    return width * width / greater_of(vector_length(across) * cosine, 1e-30f);
}

SHADING_END

#endif
