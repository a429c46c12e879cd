#pragma once

#include <functional>
#include <stop_token>

#include "client/session.h"

namespace tessera::client {

// Requests a view of the scene that the session is in and waits for its last frame. A stop asks the master for what
// is merged so far.
ViewResult render(Session& session, session::ViewRequest request,
                  const std::function<void(const session::ViewProgress&)>& on_progress, std::stop_token stop);

}  // namespace tessera::client
