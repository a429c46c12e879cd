#pragma once

#include "client/display/presenter.h"

namespace tessera::client_display {

enum class WindowMode { FullScreen, Framed };

// Windows at their outputs' positions on the desktop, through SDL2; full screen on the monitor there. Escape and q close
// a window. Throws Error{Unavailable} if there is no display.
MakePresenter make_windows(WindowMode mode);

}  // namespace tessera::client_display
