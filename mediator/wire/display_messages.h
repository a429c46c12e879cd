#pragma once

#include <cstdint>
#include <string>
#include <tuple>

#include "mediator/display/display.h"
#include "mediator/scene/blob.h"
#include "mediator/session/display.h"

// Messages between clients, output processes and the master about the display of the scene. `request` is the client's
// request number and is repeated in the reply.
namespace tessera::wire {

// Opens a display of the scene and replaces the previous one. Its description and arrays are blobs that the master
// requests from the client. Answered by RequestDone.
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
// The pose of the tracked head in display space. The latest wins; no answer.
struct MoveHead {
    display::Head head;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "head", &MoveHead::head)); }
};

// This client presents the output of that name. Answered by OutputOpened, or by RequestDone with an error.
struct JoinOutput {
    std::uint64_t request = 0;
    std::string name;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &JoinOutput::request), row(2, "name", &JoinOutput::name));
    }
};
// Sent again with request 0 when the display has changed. Pictures follow after it was answered with OutputReady of
// frame 0.
struct OutputOpened {
    std::uint64_t request = 0;
    session::OutputOpened output;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &OutputOpened::request), row(2, "output", &OutputOpened::output));
    }
};
// All pictures of a frame have arrived and it is ready to be presented. Frame 0: the description was loaded.
struct OutputReady {
    std::uint64_t frame = 0;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "frame", &OutputReady::frame)); }
};
struct PresentFrame {
    session::PresentFrame order;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "order", &PresentFrame::order)); }
};

}  // namespace tessera::wire
