#pragma once

#include "client/display/presenter.h"

namespace tessera::client_display {

enum class WindowMode { FullScreen, Framed };

// A window at the output's place on the desktop, through SDL2; full screen on the monitor that is there.
// Escape and q close it. Throws Error{Unavailable} where there is no display.
std::unique_ptr<Presenter> make_window(WindowMode mode, const display::Output& output);

}  // namespace tessera::client_display
