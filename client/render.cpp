#include "client/render.h"

namespace tessera::client {

namespace {
constexpr std::uint64_t ViewNumber = std::uint64_t{1} << 32;  // beyond those that callers choose
}

ViewResult render(Session& session, session::ViewRequest request,
                  const std::function<void(const session::ViewProgress&)>& on_progress, std::stop_token stop,
                  Session::AfterEnd after, const EarlierFilm* earlier) {
    request.frames = session::Frames::Last;
    if (earlier != nullptr) {
        session.continue_view(ViewNumber, request, *earlier);
    } else {
        session.request_view(ViewNumber, request);
    }
    return session.wait_for_end(ViewNumber, on_progress, stop, after);
}

}  // namespace tessera::client
