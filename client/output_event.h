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

// All pictures of one frame of an output. Answer with output_ready() when it is ready to be shown.
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
    std::uint64_t samples = 0;      // per pixel in the mean
    std::vector<Picture> pictures;  // left eye first
};

// The master currently has no such output; retry later.
struct OutputUnavailable {
    std::string reason;
};

using OutputEvent =
    std::variant<session::OutputOpened, OutputFrame, session::PresentFrame, OutputUnavailable>;

}  // namespace tessera::client
