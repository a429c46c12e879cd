#ifndef TESSERA_MEDIATOR_SHADING_CAMERA_H
#define TESSERA_MEDIATOR_SHADING_CAMERA_H

#include "mediator/shading/rays.h"
#include "mediator/shading/sampling.h"

SHADING_BEGIN

// Where in the neighbourhood of the pixel's centre u falls, in proportion to the pixel filter.
inline vec2 filter_offset(IN(View) view, vec2 u) {
    const float radius = view.filter_radius;
    if (view.pixel_filter == FilterGaussian) {
        return vec2(gaussian_offset(u.x, radius), gaussian_offset(u.y, radius));
    }
    if (view.pixel_filter == FilterBlackmanHarris) {
        return vec2(blackman_harris_offset(u.x, radius), blackman_harris_offset(u.y, radius));
    }
    return radius * (2.0f * u - 1.0f);
}

// Distance of a pixel's centre from the picture's middle, in pixels: exact for any picture below 2^23 pixels.
inline float from_middle(uint pixel, uint count) {
    return 0.5f * float(int(2u * pixel + 1u) - int(count));
}

// Through a point of the pixel's neighbourhood that u chooses. The way from the middle to the pixel and the
// way within the pixel are added last: in a picture of 65,536 pixels, a float that held the pixel's place
// would have few bits left for the place in the pixel.
inline Ray camera_ray(IN(View) view, uint x, uint y, vec2 u) {
    const vec2 offset = filter_offset(view, u);
    const float px = view.middle.x + (from_middle(x, view.width) * view.step.x + offset.x * view.step.x);
    const float py = view.middle.y + (from_middle(y, view.height) * view.step.y + offset.y * view.step.y);
    return Ray(view.eye, unit_vector(view.forward + px * view.right + py * view.up));
}

// Along the view axis, of a point at `distance` along a ray.
inline float depth_along(IN(View) view, IN(Ray) ray, float distance) {
    return distance * dot(ray.direction, view.forward);
}

SHADING_END

#endif
