#ifndef TESSERA_MEDIATOR_SHADING_CAMERA_H
#define TESSERA_MEDIATOR_SHADING_CAMERA_H

#include "mediator/shading/motion.h"
#include "mediator/shading/rays.h"
#include "mediator/shading/sampling.h"

SHADING_BEGIN

// Offset from the pixel's centre, distributed as the pixel filter.
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

// Distance of a pixel's centre from the image centre, in pixels: exact for pictures below 2^23 pixels.
inline float from_center(uint pixel, uint count) {
    return 0.5f * float(int(2u * pixel + 1u) - int(count));
}

// The sampled point in the image plane. The pixel's offset from the image centre and the offset within the
// pixel are added last: in a picture of 65,536 pixels, a pixel coordinate as a float has few bits left for
// the position within the pixel.
inline vec2 picture_place(IN(View) view, uint x, uint y, vec2 u) {
    const vec2 offset = filter_offset(view, u);
    return vec2(view.image_center.x + (from_center(x, view.width) * view.step.x + offset.x * view.step.x),
                view.image_center.y + (from_center(y, view.height) * view.step.y + offset.y * view.step.y));
}

// The view at a time. Without FeatureCameraMotion it is a no-op.
inline View view_at(FeatureBits features, IN(View) view, float time) {
    if ((features & FeatureCameraMotion) == 0u) return view;
    const Affine3x4 place = transform_at(view.camera_keys, 0u, view.camera_key_intervals, time);
    View moved = view;
    moved.eye = place.translation;
    moved.right = place.linear[0];
    moved.up = place.linear[1];
    moved.forward = -place.linear[2];
    return moved;
}

inline Ray pinhole_ray(IN(View) view, vec2 place) {
    return Ray(view.eye, unit_vector(view.forward + place.x * view.right + place.y * view.up));
}

// Of a pinhole camera.
inline Ray camera_ray(IN(View) view, uint x, uint y, vec2 u) {
    return pinhole_ray(view, picture_place(view, x, y, u));
}

// A point of the unit disk, in proportion to the aperture's transmittance. Gaussian: sigma
// = 1/2, cut at the rim, by inversion of its integral 1 - exp(-2 r^2), which is 1 - exp(-2) at the rim.
inline vec2 aperture_point(IN(View) view, vec2 u) {
    if ((view.camera & CameraGaussian) == 0u) return sample_disk(u);
    const float radius = sqrt(-0.5f * logarithm(1.0f - 0.864664717f * u.x));
    return radius * vec2(cosine(2.0f * Pi * u.y), sine(2.0f * Pi * u.y));
}

// Of any camera; `lens` samples its lens, if any. All rays of a point of the picture meet in one point of the
// focal plane: from a point s of the lens, the pinhole's direction changes by s / focus.
inline Ray camera_ray(IN(View) view, uint x, uint y, vec2 u, vec2 lens) {
    const vec2 place = picture_place(view, x, y, u);
    if (view.camera == CameraPinhole) return pinhole_ray(view, place);
    vec2 start = vec2(0.0f);
    vec2 tilt = vec2(0.0f);
    if ((view.camera & CameraLens) != 0u) {
        start = view.lens_radius * aperture_point(view, lens);
        tilt = -(1.0f / view.focus_distance) * start;
    }
    if ((view.camera & CameraOrthographic) != 0u) {
        start += place;
    } else {
        tilt += place;
    }
    return Ray(view.eye + (start.x * view.right + start.y * view.up),
               unit_vector(view.forward + tilt.x * view.right + tilt.y * view.up));
}

// Along the view axis, of a point at `distance` along a ray.
inline float depth_along(IN(View) view, IN(Ray) ray, float distance) {
    return distance * dot(ray.direction, view.forward);
}

// The same for a moving camera, out of line so that static cameras need no copy of the view.
COLD_NOINLINE inline Ray moving_camera_ray(IN(View) view, float time, uint x, uint y, vec2 u, vec2 lens) {
    View moved = view_at(FeatureCameraMotion, view, time);
    return camera_ray(moved, x, y, u, lens);
}
COLD_NOINLINE inline float moving_depth_along(IN(View) view, float time, vec3 direction, float distance) {
    View moved = view_at(FeatureCameraMotion, view, time);
    return depth_along(moved, Ray(moved.eye, direction), distance);
}

SHADING_END

#endif
