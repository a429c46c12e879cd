#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "mediator/display/display.h"

namespace tessera::client_display {

// What a device is to show: 8-bit red, green and blue, rows from the top. Two for Stereo::Separate, left eye
// first.
using DevicePictures = std::span<const std::vector<std::uint8_t>>;

// Where an output's pictures go. Two phases, so that the moment of showing costs nothing: prepare() does the
// work, present() shows what was prepared. One thread.
class Presenter {
  public:
    virtual ~Presenter() = default;
    // Throws Error{Io}.
    virtual void prepare(DevicePictures pictures) = 0;
    virtual void present(std::uint64_t frame) = 0;
    // Looks after the window; false when it was closed.
    virtual bool attend() { return true; }
    // How often attend() wants to be called; 0 = never.
    virtual int attention_milliseconds() const { return 0; }
};

using MakePresenter = std::function<std::unique_ptr<Presenter>(const display::Output& output)>;

}  // namespace tessera::client_display
