#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <tuple>

#include "mediator/scene/blob.h"
#include "mediator/session/edits.h"
#include "mediator/session/view_summary.h"

// Messages between clients and the master about views. Frames are sent on the bulk link. `request` is the client's
// request number and is repeated in the reply; `number` is the client's number of the view.
namespace tessera::wire {

// Film of a client that a new view goes on with.
struct EarlierFilm {
    scene::BlobRef film;  // see film_state_codec.h
    Hash128 scene_hash;   // of the scene in it
    std::uint32_t render_revision = 0;
    std::string kind;  // of the nodes that rendered it, if the view is to be reproducible
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "film", &EarlierFilm::film), row(2, "scene_hash", &EarlierFilm::scene_hash),
                          row(3, "render_revision", &EarlierFilm::render_revision),
                          row(4, "kind", &EarlierFilm::kind));
    }
};

// Requests a view, or changes the one with that number; the latest request wins. Answered by RequestDone; with
// `request` 0 only if it is refused.
struct RequestView {
    std::uint64_t request = 0, number = 0;
    session::ViewRequest wanted;
    bool share = false;  // watch the view of that name; only the delivery settings of `wanted` are used
    std::optional<EarlierFilm> earlier{};  // of a new view; else it is ignored
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &RequestView::request), row(2, "number", &RequestView::number),
                          row(3, "wanted", &RequestView::wanted), row(4, "share", &RequestView::share),
                          row(5, "earlier", &RequestView::earlier));
    }
};
// Closes the view; with `deliver` ends it and sends its current state as the last frame.
struct EndView {
    std::uint64_t number = 0;
    bool deliver = false;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "number", &EndView::number), row(2, "deliver", &EndView::deliver));
    }
};
struct ViewProgress {
    std::uint64_t number = 0;
    session::ViewProgress progress;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "number", &ViewProgress::number),
                          row(2, "progress", &ViewProgress::progress));
    }
};
// The stop rule has ended the view; `frame` is its last frame.
struct ViewDone {
    std::uint64_t number = 0, frame = 0;
    session::ViewSummary summary;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "number", &ViewDone::number), row(2, "frame", &ViewDone::frame),
                          row(3, "summary", &ViewDone::summary));
    }
};
// Acknowledges a frame, so that the next one is sent: one frame per view is in flight at a time.
struct FrameTaken {
    std::uint64_t number = 0, frame = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "number", &FrameTaken::number), row(2, "frame", &FrameTaken::frame));
    }
};
// Sets the filter of the view of that name; "" = the only view. Answered by RequestDone.
struct SetViewFilter {
    std::uint64_t request = 0;
    std::string view;
    std::string filter;  // as View::filter
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &SetViewFilter::request), row(2, "view", &SetViewFilter::view),
                          row(3, "filter", &SetViewFilter::filter));
    }
};

// Requests the surface at the center of a pixel.
struct Pick {
    std::uint64_t request = 0, number = 0;
    std::uint32_t x = 0, y = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &Pick::request), row(2, "number", &Pick::number),
                          row(3, "x", &Pick::x), row(4, "y", &Pick::y));
    }
};
struct Picked {
    std::uint64_t request = 0;
    session::PickResult result;
    std::string problem;  // not empty: error
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &Picked::request), row(2, "result", &Picked::result),
                          row(3, "problem", &Picked::problem));
    }
};

}  // namespace tessera::wire
