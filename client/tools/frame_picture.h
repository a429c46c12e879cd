#pragma once

#include <vector>

#include "client/frame.h"
#include "mediator/frame/image.h"
#include "mediator/picture/exr_writer.h"

namespace tessera::tools {

// RGB of a frame with planes at the full size of its view; coarse frames have larger pixels. Throws Error{InvalidInput} if the
// picture does not match its header.
frame::Image picture_of(const client::Frame& frame, std::uint32_t width, std::uint32_t height);

// This picture of a frame, and what an EXR of its film would show, at the same size. The samples are a layer of their own if the
// picture is denoised.
enum class Samples { AreThePicture, AreDenoised };
std::vector<picture::Layer> layers_of(const client::Frame& frame, const frame::Image& picture,
                                      Samples samples);

}  // namespace tessera::tools
