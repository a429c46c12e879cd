#pragma once

#include <functional>
#include <stop_token>

#include "client/session.h"

namespace tessera::client {

// Requests a view of the scene that the session is in and waits for its last frame. A stop requests the samples
// merged so far from the master. Keep: the next call continues the view, so that its denoiser has a history. `earlier`: film that
// the view goes on with.
ViewResult render(Session& session, session::ViewRequest request,
                  const std::function<void(const session::ViewProgress&)>& on_progress, std::stop_token stop,
                  Session::AfterEnd after = Session::AfterEnd::Close, const EarlierFilm* earlier = nullptr);

}  // namespace tessera::client
