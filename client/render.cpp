#include "client/render.h"

namespace tessera::client {

namespace {
constexpr std::uint64_t ViewNumber = std::uint64_t{1} << 32;  // beyond those that callers choose
constexpr std::uint64_t PreviewNumber = ViewNumber + 1;       // under which the session watches its own view

session::ViewRequest preview_of(const session::ViewRequest& request) {
    session::ViewRequest preview{.name = request.name};
    preview.picture = session::PictureEncoding::Planes;
    preview.film = true;
    return preview;
}
}  // namespace

ViewResult render(Session& session, session::ViewRequest request,
                  const std::function<void(const session::ViewProgress&)>& on_progress, std::stop_token stop,
                  Session::AfterEnd after, const EarlierFilm* earlier,
                  const std::function<void(const Frame&)>& on_frame) {
    request.frames = session::Frames::Last;
    if (on_frame && request.name.empty()) request.name = "picture";
    if (earlier != nullptr) {
        session.continue_view(ViewNumber, request, *earlier);
    } else {
        session.request_view(ViewNumber, request);
    }
    if (!on_frame) return session.wait_for_end(ViewNumber, on_progress, stop, after);
    session.share_view(PreviewNumber, preview_of(request));
    const auto on_news = [&](const session::ViewProgress& progress) {
        if (on_progress) on_progress(progress);
        if (const auto frame = session.take_frame(PreviewNumber)) on_frame(*frame);
    };
    ViewResult result = session.wait_for_end(ViewNumber, on_news, stop, after);
    session.close_view(PreviewNumber);
    return result;
}

}  // namespace tessera::client
