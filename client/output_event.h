#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "mediator/session/display.h"
#include "mediator/session/view_request.h"
#include "mediator/view/view.h"

namespace tessera::client {

// All pictures of one frame of an output. To be answered with output_ready() when it could be shown.
struct OutputFrame {
    struct Picture {
        view::Eye eye = view::Eye::Mono;
        view::CameraPose camera;  // in display space
        std::uint32_t width = 0, height = 0;
        session::PictureEncoding encoding = session::PictureEncoding::Bytes;  // or Half
        std::vector<std::byte> bytes;
    };
    std::uint64_t number = 0;
    Version version;
    std::uint64_t samples = 0;      // of a pixel, the least
    std::vector<Picture> pictures;  // left eye first
};

// The master has no such output now, and why; it is to be asked for again.
struct OutputUnavailable {
    std::string reason;
};

using OutputEvent =
    std::variant<session::OutputOpened, OutputFrame, session::PresentFrame, OutputUnavailable>;

}  // namespace tessera::client
