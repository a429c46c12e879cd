#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "master/render/view_request.h"
#include "mediator/session/view_summary.h"
#include "mediator/wire/journal_records.h"

namespace tessera::master {

// A rendering pass of a view. Coarse passes render at a fraction of its size with one sample per pixel; feature
// passes render the guides for upsampling a smaller picture; the last pass accumulates the picture itself. Each has its
// own film and scheduler, identified by the id of its view (film_store.h, dispatcher.h).
struct Pass {
    enum class Kind : std::uint8_t { Coarse, Features, Picture };
    view::View view;  // as nodes render it; with the id of the pass
    Kind kind = Kind::Picture;
    std::uint32_t scale = 1;  // 8, 4, 2: at 1/scale of the size
    std::uint64_t spp = 1;
    std::optional<TimePoint> deadline;  // ends the pass even if it is not complete
    std::uint32_t tiles = 0;            // once begun
};

// The state that can be displayed: a coarse pass once complete, the last pass from its first whole round on.
struct DisplayedState {
    std::size_t pass = 0;
    std::uint64_t revision = 0, asked = 0;  // of the passes, and of the request: the filter may differ
    std::uint64_t samples = 0;              // merged so far, of all pixels
    bool complete = false;
    friend bool operator==(const DisplayedState&, const DisplayedState&) = default;
};

// Progress of a view; reset when its passes restart.
struct Run {
    session::Phase phase = session::Phase::WaitingForNodes;
    TimePoint started{}, rendering_since{};
    TimePoint without_nodes_since{};       // or without progress of those that sync
    std::uint64_t synced_bytes = 0;        // by nodes that sync, when that was last checked
    std::optional<TimePoint> ready_since;  // with a budget: the nodes are ready
    std::optional<TimePoint> deadline;     // of sampling
    std::string kind;                      // of the nodes of a reproducible frame, once chosen
    std::vector<std::string> left_out;     // nodes that take no part, and why; when the frame ends
    std::string cost_key;                  // with a budget: key of the predicted cost (time_budget.h)
    double predicted_seconds = 0.0;        // with a budget: from the deadline to the encoded picture
    bool calibrating = false;
    std::uint32_t scale = 1;                  // rendered at 1/scale of the size, and upsampled
    std::optional<session::Outcome> outcome;  // decided; units may still be in flight
    TimePoint outcome_at{};
    std::string message;  // why, unless complete
    std::optional<TimePoint> first_picture, ended;
    std::uint64_t samples = 0;                     // merged in the current pass, of all pixels
    std::uint64_t samples_before = 0;              // of these, in the film that it continues
    TimePoint seen_at{};                           // when `samples` was updated
    std::map<NodeId, session::NodeSummary> nodes;  // all that took part, including disconnected ones
    session::UnitCounts units;                     // of the current pass
    std::uint64_t rays = 0, nonfinite_samples = 0;
    std::uint32_t steps = 0;   // of an adaptive picture
    bool is_deciding = false;  // the next one
    bool is_widened =
        false;  // its later samples have more channels: all pixels get as many, without decisions
    TimePoint deciding_since{};
    Duration deciding{0};          // in all steps
    bool step_is_uniform = false;  // with nothing but a clock: no pixel was chosen by its noise
    double noise = 0.0;            // as of the last decision; 0: unknown
    double error = 0.0;            // likewise, of the filtered picture
    std::uint64_t samples_expected = 0;
    session::WireBytes bytes_before;  // the master's counters at the start

    bool is_rendering() const { return phase == session::Phase::Rendering; }
    bool is_over() const { return phase == session::Phase::Filtering || phase == session::Phase::Delivering; }
};

// Film that a view goes on with: of a master that was restarted, or of a client.
struct EarlierFilm {
    std::vector<frame::FilmTile> blocks;
    std::uint32_t steps = 0;            // of an adaptive pass: decided ones
    std::vector<wire::SavedPart> step;  // the last one
};

// The client that opened a view. Owners with the same user and key are equal.
struct ViewOwner {
    SessionId session;
    std::string name, user;
    std::uint64_t key = 0;
};

// A view of a scene and its progress. Whenever the picture changes, the passes restart.
struct ViewState {
    ViewId id;  // passes have this id and the following ones
    std::string name;
    ViewOwner owner;
    view::View asked;              // as requested by its owner
    session::ViewRequest request;  // the same with the channels that its filter needs
    std::optional<std::uint32_t>
        group_priority;                // in lockstep with others (lockstep_group.h), without an owner
    std::uint64_t asked_revision = 0;  // of the request
    std::uint64_t camera_revision = 0;
    std::uint64_t revision = 0;          // of the passes
    std::uint64_t films = 0;             // begun, the current one included
    Version version;                     // of the scene in the film
    Hash128 scene_hash;                  // likewise
    std::optional<EarlierFilm> earlier;  // until its first pass begins
    std::string earlier_kind;            // of the nodes that rendered it, if the view is reproducible
    std::vector<Pass> passes;
    std::size_t current = 0;     // index of the current pass
    bool restart_wanted = true;  // the passes must restart
    std::optional<DisplayedState> shown;
    Run run;
    TimePoint waits_since{};  // for a suitable node
    bool wait_notified = false;
    TimePoint progress_sent{};
    std::optional<TimePoint> orphaned;  // since it has no watchers; it waits for its owner to reconnect
    std::vector<session::FailedTile> failed_tiles;  // of its passes since the restart, in the full size
    std::string problem;                            // why it is not rendered; "" = none

    bool in_group() const { return group_priority.has_value(); }
    std::uint32_t priority() const { return group_priority.value_or(1); }
    bool shows_all() const { return request.frames == session::Frames::All; }
    Pass& pass() { return passes[current]; }
    const Pass& pass() const { return passes[current]; }
    bool is_last_pass() const { return current + 1 == passes.size(); }
    // The first picture after a restart is not complete: changes wait for it, so that the display keeps updating
    // however fast edits arrive.
    bool awaiting_first_frame() const {
        return shows_all() && problem.empty() && !passes.empty() && (!shown || shown->revision != revision);
    }
    // Its client waited for the end, which is decided: it is not rendered again unless the client asks for it. Once asked
    // for it follows the scene, although the outcome is known until the restart.
    bool has_ended() const { return !shows_all() && !restart_wanted && run.outcome.has_value(); }
    bool is_complete() const { return shown && shown->complete && shown->revision == revision; }
};

// Whether a picture at 1/`scale` of the size still has 16 pixels a side.
bool has_coarse_pass(const view::View& view, std::uint32_t scale);
// The passes of a view: if it shows all frames, coarse passes at 1/8, 1/4 and 1/2 of its size (where has_coarse_pass(),
// and not coarser than 1/`coarsest`); features if it is upsampled; then the picture. If it shows all frames and its filter
// keeps a history, every film has a seed of its own: equal random numbers would not average out over pictures.
std::vector<Pass> passes_of(const ViewState& view, std::uint32_t coarsest = 8);

inline constexpr std::size_t MaxPasses = 8;  // of a view

}  // namespace tessera::master
