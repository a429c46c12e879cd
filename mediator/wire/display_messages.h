#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mediator/base/ids.h"
#include "mediator/display/display.h"
#include "mediator/scene/blob.h"

// What clients, output processes and the master say to each other about the display of a live scene.
// `request` is the asking client's number and comes back with the answer.
namespace tessera::wire {

// Puts a display in front of the live scene, instead of the one there was. Its description and arrays are
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
// What is set is changed, at once for all outputs. Answered by RequestDone.
struct AdjustDisplay {
    std::uint64_t request = 0;
    std::optional<double> eye_separation, zero_parallax, exposure;
    std::optional<bool> pattern;                // show the test pattern instead of the scene
    std::optional<std::uint32_t> shown_layers;  // bit i: layer i
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &AdjustDisplay::request),
                          row(2, "eye_separation", &AdjustDisplay::eye_separation),
                          row(3, "zero_parallax", &AdjustDisplay::zero_parallax),
                          row(4, "exposure", &AdjustDisplay::exposure),
                          row(5, "pattern", &AdjustDisplay::pattern),
                          row(6, "shown_layers", &AdjustDisplay::shown_layers));
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
    scene::BlobRef description;
    std::uint32_t index = 0;  // of the output in it
    bool pattern = false;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &OutputOpened::request),
                          row(2, "description", &OutputOpened::description),
                          row(3, "index", &OutputOpened::index), row(4, "pattern", &OutputOpened::pattern));
    }
};
// All pictures of a frame are there, ready to be shown; pictures that were never of use for it are forgotten.
// Frame 0: the description was taken in.
struct OutputReady {
    std::uint64_t frame = 0;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "frame", &OutputReady::frame)); }
};
// Every output that was ready shows this frame at that time; one that does not have it shows what it has.
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

enum class OutputState : std::uint8_t {
    Absent,  // no process shows it
    Joining,
    Locked,
    Late,  // was not ready in time and is not waited for until it answers
};
constexpr auto enumerators(OutputState) {
    return std::to_array<std::string_view>({"absent", "joining", "locked", "late"});
}
struct OutputStatus {
    std::string name, host;
    OutputState state = OutputState::Absent;
    std::uint64_t frames = 0;  // presented
    std::uint64_t late = 0;    // times that it was dropped from the lock
    double stereo_difference =
        0.0;                    // of the latest complete frame: see picture/stereo_difference.h; 0 = unknown
    std::uint64_t samples = 0;  // of a pixel, in the latest frame
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &OutputStatus::name), row(2, "host", &OutputStatus::host),
                          row(3, "state", &OutputStatus::state), row(4, "frames", &OutputStatus::frames),
                          row(5, "late", &OutputStatus::late),
                          row(6, "stereo_difference", &OutputStatus::stereo_difference),
                          row(7, "samples", &OutputStatus::samples));
    }
};
struct DisplayStatus {
    std::string name;  // "" = none
    std::uint64_t frames = 0;
    Version version;  // of the latest frame
    double rate = 0;  // frames a second, of late
    std::vector<OutputStatus> outputs;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &DisplayStatus::name), row(2, "frames", &DisplayStatus::frames),
                          row(3, "version", &DisplayStatus::version), row(4, "rate", &DisplayStatus::rate),
                          row(5, "outputs", &DisplayStatus::outputs, Limit{display::MaxOutputs}));
    }
};

}  // namespace tessera::wire
