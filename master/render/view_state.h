#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "master/render/view_request.h"
#include "mediator/session/view_summary.h"

namespace tessera::master {

// A pass over a view: coarse ones are pictures of a part of its size with one sample a pixel; features are
// what a smaller picture is upsampled by; the last one is the picture itself and accumulates. Each has a film
// and a ledger of its own, which go by the id of its view (film_store.h, dispatcher.h).
struct Pass {
    enum class Kind : std::uint8_t { Coarse, Features, Picture };
    view::View view;  // as nodes render it; its id is the pass's own
    Kind kind = Kind::Picture;
    std::uint32_t scale = 1;  // 8, 4, 2: of this part of the size
    std::uint64_t spp = 1;
    std::optional<TimePoint> deadline;  // ends the pass even if it is not complete
    std::uint32_t tiles = 0;            // once begun
};

// What can be shown: a coarse pass when it is complete, the last one from its first whole round on.
struct Shown {
    std::size_t pass = 0;
    std::uint64_t revision = 0, asked = 0;  // of the passes, and of what was asked for: the filter may differ
    std::uint64_t samples = 0;              // merged so far, of all pixels
    bool complete = false;
    friend bool operator==(const Shown&, const Shown&) = default;
};

// Where a view is on its way to its end; starts over with its passes.
struct Run {
    session::Phase phase = session::Phase::WaitingForNodes;
    TimePoint started{}, rendering_since{};
    TimePoint without_nodes_since{};
    std::optional<TimePoint> ready_since;  // with a budget: the nodes are ready
    std::optional<TimePoint> deadline;     // of sampling
    std::string way;                       // with a budget: how the picture is made (time_budget.h)
    double predicted_seconds = 0.0;        // with a budget: from the deadline to the encoded picture
    bool rehearsing = false;
    std::uint32_t scale = 1;                  // rendered at this part of the size, and upsampled
    std::optional<session::Outcome> outcome;  // decided; units may still be on their way back
    TimePoint outcome_at{};
    std::string message;  // why, unless complete
    std::optional<TimePoint> first_picture, ended;
    std::uint64_t samples = 0;                     // merged in the pass under way, of all pixels
    TimePoint seen_at{};                           // when that was so
    std::map<NodeId, session::NodeSummary> nodes;  // all that took part, gone ones too
    session::UnitCounts units;                     // of the pass under way
    std::uint64_t rays = 0, nonfinite_samples = 0;
    session::WireBytes bytes_before;  // the master's counters at the start

    bool is_rendering() const { return phase == session::Phase::Rendering; }
    bool is_over() const { return phase == session::Phase::Filtering || phase == session::Phase::Delivering; }
};

// Who opened a view. Whoever has the same user and key is the same.
struct ViewOwner {
    SessionId session;
    std::string name, user;
    std::uint64_t key = 0;
};

// A view of a scene and where its picture is. Whenever the picture changes, the passes start over.
struct ViewState {
    ViewId id;  // passes have the ids from here on
    std::string name;
    ViewOwner owner;
    view::View asked;              // as its owner said it
    session::ViewRequest request;  // its view with the channels that its filter needs
    std::optional<std::uint32_t>
        group_priority;                // in lockstep with others (lockstep_group.h), without an owner
    std::uint64_t asked_revision = 0;  // of what was asked for, and of what the passes render
    std::uint64_t camera_revision = 0;
    std::uint64_t revision = 0;  // of the passes
    Version version;             // of the scene in the film
    std::vector<Pass> passes;
    std::size_t current = 0;     // the pass under way
    bool restart_wanted = true;  // a picture of what is now is due
    std::optional<Shown> shown;
    Run run;
    TimePoint waits_since{};  // for a node that could render it
    bool told_of_waiting = false;
    TimePoint progress_sent{};
    std::optional<TimePoint> orphaned;  // since nobody watches it; it waits for its owner to come back
    std::uint32_t failures = 0;         // units a back-end failed on
    std::string problem;                // why it is not rendered; "" = it is

    bool in_group() const { return group_priority.has_value(); }
    std::uint32_t priority() const { return group_priority.value_or(1); }
    bool shows_all() const { return request.frames == session::Frames::All; }
    Pass& pass() { return passes[current]; }
    const Pass& pass() const { return passes[current]; }
    bool is_last_pass() const { return current + 1 == passes.size(); }
    // The first picture after a restart is on its way: what changes meanwhile waits for it, so that something
    // new is shown however fast edits come.
    bool is_protected() const {
        return shows_all() && problem.empty() && !passes.empty() && (!shown || shown->revision != revision);
    }
    bool is_complete() const { return shown && shown->complete && shown->revision == revision; }
};

// Whether a picture of 1/`scale` of its size still has 16 pixels a side.
bool has_coarse_pass(const view::View& view, std::uint32_t scale);
// The passes of a view: of one that shows all frames 1/8, 1/4 and 1/2 of its size, each where there is one
// and it is not coarser than 1/`coarsest`; features where it is upsampled; then the picture.
std::vector<Pass> passes_of(const ViewState& view, std::uint32_t coarsest = 8);

inline constexpr std::size_t MaxPasses = 8;  // of a view

}  // namespace tessera::master
