#pragma once

#include <map>
#include <optional>
#include <string>

#include "master/render/reconstruction.h"
#include "master/render/schedule/scheduler.h"
#include "mediator/wire/messages.h"

namespace tessera::master {

// One frame that a client asked for, from StartJob to JobDone.
struct Job {
    wire::StartJob request;  // with the view as it is rendered: id, revision
    SessionId session;
    Version version;  // of the scene
    std::uint32_t tile_edge = 32;
    wire::JobPhase phase = wire::JobPhase::WaitingForNodes;
    TimePoint started{};  // StartJob came
    TimePoint without_nodes_since{};
    TimePoint rendering_since{};
    std::optional<TimePoint> deadline;      // of sampling
    std::optional<TimePoint> budget_since;  // with a budget: when the nodes were ready
    std::string way;                        // with a budget: how the picture is made (time_budget.h)
    double predicted_seconds = 0.0;         // with a budget: from the deadline to the encoded picture
    bool rehearsing = false;
    std::optional<TimePoint> stage_deadline;
    std::uint64_t full_pixels = 0;    // of the picture, if it is upsampled
    std::uint32_t scale = 1;          // rendered at this part of the size
    std::optional<view::View> stage;  // not the request's view: the features of a picture to be upsampled
    std::optional<TimePoint> first_picture;
    std::optional<TimePoint> ended;
    std::optional<Scheduler> scheduler;       // from the phase Rendering on
    std::optional<wire::JobOutcome> outcome;  // decided; units may still be on their way back
    TimePoint outcome_at{};
    std::string message;
    std::map<NodeId, wire::NodeSummary> nodes;  // all that took part, gone ones too
    std::uint32_t failures = 0;                 // units a back-end failed on
    std::uint64_t rays = 0, nonfinite_samples = 0;
    std::uint64_t triangles = 0, instances = 0, lights = 0;
    wire::WireBytes bytes_before;  // the master's counters at the start
    TimePoint last_progress_sent{};
    std::optional<Reconstruction> picture;              // from the phase Delivering on, if one was asked for
    std::uint64_t samples_least = 0, samples_most = 0;  // of a pixel, with a picture
    std::uint64_t picture_sent = 0;                     // bytes; Delivering
    std::uint32_t tiles_requested = 0, tiles_sent = 0;  // Delivering

    bool rendering() const { return phase == wire::JobPhase::Rendering; }
};

// Checks what a client asks for: sizes, finite camera, window inside the picture, channels, counts. Empty =
// fine.
std::string problem_of(const wire::StartJob& request);

// Adds what the view's filter needs: channels, and the path class where the filter is made for one.
void complete(view::View& view);

// What the time from the film to the encoded picture depends on (time_budget.h).
std::string way_of(const wire::StartJob& request);

// For a picture that is rendered at half or a quarter of the size: the first stage, features of the full
// size, one sample each; and the small view itself.
view::View feature_view(const view::View& view);
view::View scaled_view(const view::View& view, std::uint32_t scale);

// The edge of the tiles: what was asked for, else 128 for the renderer Raster, 64 for large pictures and 32
// for small ones; never so large that the film of one tile exceeds a bulk message.
std::uint32_t choose_tile_edge(const wire::StartJob& request);

inline constexpr std::uint64_t MaxSamplesPerPixel = std::uint64_t{1} << 31;  // counts are 32 bits

}  // namespace tessera::master
