#pragma once

#include <tbb/task_arena.h>

#include <span>

#include "mediator/display/device_color.h"
#include "mediator/display/point_grid.h"
#include "mediator/frame/image.h"
#include "mediator/view/view.h"

// What people in front of screens see: the pictures of devices thrown back to where they are seen. A device's
// light is taken to be as bright everywhere on the screen, and the device to be what its description says.
namespace tessera::display {

// The linear light of a device's picture (rgb of 3 values a pixel, in [0, 1] of the device's codes), upright:
// its curve, gain and matrix undone. `black` is the light that it sends where it is sent black, as a part of
// white.
frame::Image light_of(const Output& output, std::span<const float> device_values, double black);
frame::Image light_of(const Output& output, std::span<const std::uint8_t> device_bytes, double black);

// One eye's part of the light of an output that packs both: halves or alternate rows; for others all of it.
frame::Image part_of_eye(const Output& output, const frame::Image& light, view::Eye eye);

// An output on its screen.
struct SeenOutput {
    const PointGrid* points = nullptr;
    const frame::Image* light = nullptr;  // 3 components, of any size: it fills the output's picture
};

// The picture of a camera in display space that looks at the screens: light of all outputs added, bilinear
// between the pixels of each. Of a flat wall and a camera that looks straight at it, the wall itself.
frame::Image seen(const view::CameraPose& camera, std::uint32_t width, std::uint32_t height,
                  std::span<const SeenOutput> outputs, tbb::task_arena& arena);

}  // namespace tessera::display
