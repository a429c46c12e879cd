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
};
struct CloseDisplay {
    std::uint64_t request = 0;
};
// What is set is changed, at once for all outputs. Answered by RequestDone.
struct AdjustDisplay {
    std::uint64_t request = 0;
    std::optional<double> eye_separation, zero_parallax, exposure;
    std::optional<bool> pattern;                // show the test pattern instead of the scene
    std::optional<std::uint32_t> shown_layers;  // bit i: layer i
};
// Where the tracked head is, in display space. The latest wins; no answer.
struct MoveHead {
    display::Head head;
};

// This client shows the output of that name. Answered by OutputOpened, or by RequestDone with the reason.
struct JoinOutput {
    std::uint64_t request = 0;
    std::string name;
};
// Again, with request 0, when the display has changed. Pictures come when it is answered: OutputReady of
// frame 0.
struct OutputOpened {
    std::uint64_t request = 0;
    scene::BlobRef description;
    std::uint32_t index = 0;  // of the output in it
    bool pattern = false;
};
// All pictures of a frame are there, ready to be shown; pictures that were never of use for it are forgotten.
// Frame 0: the description was taken in.
struct OutputReady {
    std::uint64_t frame = 0;
};
// Every output that was ready shows this frame at that time; one that does not have it shows what it has.
struct PresentFrame {
    std::uint64_t frame = 0;
    Version version;
    std::int64_t at = 0;     // ns, the receiver's clock
    std::int64_t bound = 0;  // ns, of that clock's offset
};

enum class OutputState : std::uint8_t {
    Absent,  // no process shows it
    Joining,
    Locked,
    Late,  // was not ready in time and is not waited for until it answers
};
struct OutputStatus {
    std::string name, host;
    OutputState state = OutputState::Absent;
    std::uint64_t frames = 0;  // presented
    std::uint64_t late = 0;    // times that it was dropped from the lock
    double stereo_difference =
        0.0;                    // of the latest complete frame: see picture/stereo_difference.h; 0 = unknown
    std::uint64_t samples = 0;  // of a pixel, in the latest frame
};
struct DisplayStatus {
    std::string name;  // "" = none
    std::uint64_t frames = 0;
    Version version;  // of the latest frame
    double rate = 0;  // frames a second, of late
    std::vector<OutputStatus> outputs;
};

}  // namespace tessera::wire
