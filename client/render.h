#pragma once

#include <functional>
#include <stop_token>

#include "client/session.h"

namespace tessera::client {

// Requests a view of the scene that the session is in and waits for its last frame. A stop requests the samples
// merged so far from the master. Keep: the next call continues the view, so that its denoiser has a history. `earlier`: film that
// the view goes on with. `on_frame`, if not empty, gets frames of the unfinished picture, with planes and film.
ViewResult render(Session& session, session::ViewRequest request,
                  const std::function<void(const session::ViewProgress&)>& on_progress, std::stop_token stop,
                  Session::AfterEnd after = Session::AfterEnd::Close, const EarlierFilm* earlier = nullptr,
                  const std::function<void(const Frame&)>& on_frame = {});

}  // namespace tessera::client
