#pragma once

#include <tbb/task_arena.h>

#include <span>

#include "mediator/display/device_color.h"
#include "mediator/display/warp_map.h"
#include "mediator/frame/image.h"
#include "mediator/view/view.h"

// Simulates what a viewer in front of the screens sees: device pictures are projected back onto their screens. Assumes
// uniform brightness over the screen, and devices that match their descriptions.
namespace tessera::display {

// The linear light of a device's picture (rgb of 3 values a pixel, in [0, 1] of the device's codes), upright:
// its curve, gain and matrix undone. `black` is the device's black level, as a fraction of white.
frame::Image light_of(const Output& output, std::span<const float> device_values, double black);
frame::Image light_of(const Output& output, std::span<const std::uint8_t> device_bytes, double black);

// One eye's part of the light of an output that packs both eyes: halves or alternate rows; otherwise all of it.
frame::Image part_of_eye(const Output& output, const frame::Image& light, view::Eye eye);

// An output on its screen.
struct ProjectedOutput {
    const WarpMap* points = nullptr;
    const frame::Image* light = nullptr;  // 3 components, of any size; covers the output's picture
};

// The picture of a camera in display space that looks at the screens: the sum of the light of all outputs,
// bilinearly interpolated. For a camera that looks straight at a flat wall this is the wall's own picture.
frame::Image viewer_picture(const view::CameraPose& camera, std::uint32_t width, std::uint32_t height,
                            std::span<const ProjectedOutput> outputs, tbb::task_arena& arena);

}  // namespace tessera::display
