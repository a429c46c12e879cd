#pragma once

#include <cstdint>
#include <string>
#include <tuple>

#include "mediator/session/edits.h"
#include "mediator/session/view_summary.h"

// What clients and the master say to each other about views. Their frames come over the bulk link. `request` is the
// asking client's number and comes back with the answer; `number` is the client's own number of the view.
namespace tessera::wire {

// Again with the same number: another camera, size or quality, the latest wins. Answered by RequestDone; with
// `request` 0 only a refusal is.
struct RequestView {
    std::uint64_t request = 0, number = 0;
    session::ViewRequest wanted;
    bool share = false;  // watch the view that has this name: of `wanted`, what is delivered means something
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &RequestView::request), row(2, "number", &RequestView::number),
                          row(3, "wanted", &RequestView::wanted), row(4, "share", &RequestView::share));
    }
};
// The client is done with the view; or, with `deliver`, wants what there is of it as its last frame.
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
// The stop rule has ended the view; `frame` shows its end.
struct ViewDone {
    std::uint64_t number = 0, frame = 0;
    session::ViewSummary summary;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "number", &ViewDone::number), row(2, "frame", &ViewDone::frame),
                          row(3, "summary", &ViewDone::summary));
    }
};
// The next frame may come: one of a view is on its way at a time.
struct FrameTaken {
    std::uint64_t number = 0, frame = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "number", &FrameTaken::number), row(2, "frame", &FrameTaken::frame));
    }
};
// Another filter for the view of that name; "" = the one view there is. Answered by RequestDone.
struct SetViewFilter {
    std::uint64_t request = 0;
    std::string view;
    std::string filter;  // as View::filter
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &SetViewFilter::request), row(2, "view", &SetViewFilter::view),
                          row(3, "filter", &SetViewFilter::filter));
    }
};

// What is seen in the middle of a pixel.
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
    session::Picked seen;
    std::string problem;  // not empty: there is no answer, and why
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &Picked::request), row(2, "seen", &Picked::seen),
                          row(3, "problem", &Picked::problem));
    }
};

}  // namespace tessera::wire
