#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "mediator/display/display.h"

namespace tessera::client_display {

// The pictures of a device: 8-bit red, green and blue, rows from the top. Two for Stereo::Separate, left eye first.
using DevicePictures = std::span<const std::vector<std::uint8_t>>;

// Presents an output's pictures in two phases: prepare() does the work, present() is cheap and shows the prepared
// pictures. Single-threaded.
class Presenter {
  public:
    virtual ~Presenter() = default;
    // Throws Error{Io}.
    virtual void prepare(DevicePictures pictures) = 0;
    virtual void present(std::uint64_t frame) = 0;
    // Handles window events; false when the window was closed.
    virtual bool attend() { return true; }
    // Interval at which attend() should be called; 0 = never.
    virtual int attention_milliseconds() const { return 0; }
};

using MakePresenter = std::function<std::unique_ptr<Presenter>(const display::Output& output)>;

}  // namespace tessera::client_display
