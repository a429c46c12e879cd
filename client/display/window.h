#pragma once

#include "client/display/presenter.h"

namespace tessera::client_display {

enum class WindowMode { FullScreen, Framed };

// Windows at their outputs' places on the desktop, through SDL2; full screen on the monitor that is there.
// Escape and q close one. Throws Error{Unavailable} at once where there is no display.
MakePresenter make_windows(WindowMode mode);

}  // namespace tessera::client_display
