#pragma once

#include <cstdint>
#include <string>
#include <tuple>

#include "mediator/display/display.h"
#include "mediator/scene/blob.h"
#include "mediator/session/display.h"

// What clients, output processes and the master say to each other about the display in front of the scene.
// `request` is the asking client's number and comes back with the answer.
namespace tessera::wire {

// Puts a display in front of the scene, instead of the one there was. Its description and arrays are
// blobs that the master asks the client for. Answered by RequestDone.
struct OpenDisplay {
    std::uint64_t request = 0;
    scene::BlobRef description;  // an encoded display::Display
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &OpenDisplay::request),
                          row(2, "description", &OpenDisplay::description));
    }
};
struct CloseDisplay {
    std::uint64_t request = 0;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "request", &CloseDisplay::request)); }
};
// Answered by RequestDone.
struct AdjustDisplay {
    std::uint64_t request = 0;
    session::DisplayAdjustment adjustment;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &AdjustDisplay::request),
                          row(2, "adjustment", &AdjustDisplay::adjustment));
    }
};
// Where the tracked head is, in display space. The latest wins; no answer.
struct MoveHead {
    display::Head head;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "head", &MoveHead::head)); }
};

// This client shows the output of that name. Answered by OutputOpened, or by RequestDone with the reason.
struct JoinOutput {
    std::uint64_t request = 0;
    std::string name;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &JoinOutput::request), row(2, "name", &JoinOutput::name));
    }
};
// Again, with request 0, when the display has changed. Pictures come when it is answered: OutputReady of
// frame 0.
struct OutputOpened {
    std::uint64_t request = 0;
    session::OutputOpened output;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &OutputOpened::request), row(2, "output", &OutputOpened::output));
    }
};
// All pictures of a frame are there, ready to be shown; pictures that were never of use for it are forgotten.
// Frame 0: the description was taken in.
struct OutputReady {
    std::uint64_t frame = 0;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "frame", &OutputReady::frame)); }
};
struct PresentFrame {
    session::PresentFrame order;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "order", &PresentFrame::order)); }
};

}  // namespace tessera::wire
