#pragma once

#include <cstdint>
#include <optional>
#include <tuple>

#include "mediator/base/description.h"
#include "mediator/base/ids.h"
#include "mediator/scene/blob.h"

// Adjustments of an open display, and the messages to its outputs.
namespace tessera::session {

// The fields that are set are changed, for all outputs simultaneously.
struct DisplayAdjustment {
    std::optional<double> eye_separation, zero_parallax, exposure;
    std::optional<bool> pattern;                // show the test pattern instead of the scene
    std::optional<std::uint32_t> shown_layers;  // bit i: layer i
    static constexpr auto describe(auto row) {
        using Self = DisplayAdjustment;
        return std::tuple(row(1, "eye_separation", &Self::eye_separation),
                          row(2, "zero_parallax", &Self::zero_parallax), row(3, "exposure", &Self::exposure),
                          row(4, "pattern", &Self::pattern), row(5, "shown_layers", &Self::shown_layers));
    }
};

// An output of the open display.
struct OutputOpened {
    scene::BlobRef description;  // an encoded display::Display
    std::uint32_t index = 0;     // of the output in it
    bool pattern = false;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "description", &OutputOpened::description),
                          row(2, "index", &OutputOpened::index), row(3, "pattern", &OutputOpened::pattern));
    }
};

// Every output that is ready presents this frame at that time; one that does not have it keeps its last frame.
struct PresentFrame {
    std::uint64_t frame = 0;
    Version version;
    std::int64_t at = 0;     // ns, the receiver's clock
    std::int64_t bound = 0;  // ns, of that clock's offset
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "frame", &PresentFrame::frame), row(2, "version", &PresentFrame::version),
                          row(3, "at", &PresentFrame::at), row(4, "bound", &PresentFrame::bound));
    }
};

}  // namespace tessera::session
