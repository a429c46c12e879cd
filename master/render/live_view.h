#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "master/render/schedule/scheduler.h"
#include "mediator/view/view.h"
#include "mediator/wire/messages.h"

namespace tessera::master {

// A pass over a live view: coarse ones are pictures of a part of its size with one sample a pixel and a film
// of their own that ends with them; the last one is the view itself and accumulates.
struct LivePass {
    view::View view;  // as nodes render it; its id is the pass's own
    std::uint32_t scale = 1;
    std::uint64_t spp = 1;
    UnitId first_unit;                   // its units have ids from here, UnitsPerPass of them
    std::optional<Scheduler> scheduler;  // once begun
};

// What can be shown: a coarse pass when it is complete, the last one from its first whole round on.
struct Shown {
    std::size_t pass = 0;
    std::uint64_t revision = 0, samples = 0;  // samples: merged so far, of all pixels
    bool complete = false;
    friend bool operator==(const Shown&, const Shown&) = default;
};

// A view of a live scene and where its picture is. Whenever the picture changes, the passes start over.
struct LiveView {
    ViewId id;  // passes have the ids from here on
    std::string name;
    SessionId owner;
    std::string owner_name, owner_user;
    std::uint64_t owner_key = 0;  // as it joined: who comes back with it has the view again
    view::View view;              // as asked for, with the channels that its filter needs
    std::uint64_t spp = 1;
    bool in_group = false;             // in lockstep with others (view_group.h), without an owner
    std::uint32_t priority = 1;        // in a group
    std::uint64_t asked_revision = 0;  // of what was asked for, and of what the passes render
    std::uint64_t camera_revision = 0;
    std::uint64_t revision = 0;  // of the passes
    Version version;             // of the scene in the film
    std::vector<LivePass> passes;
    std::size_t current = 0;     // the pass under way
    bool restart_wanted = true;  // a picture of what is now is due
    std::optional<Shown> shown;
    TimePoint without_nodes_since{};
    bool told_of_waiting = false;
    std::optional<TimePoint> orphaned;  // since nobody watches it; it waits for its owner to come back
    std::uint32_t failures = 0;
    std::string problem;  // why it is not rendered; "" = it is

    LivePass& pass() { return passes[current]; }
    const LivePass& pass() const { return passes[current]; }
    // The first picture after a restart is on its way: what changes meanwhile waits for it, so that something
    // new is shown however fast edits come.
    bool is_protected() const {
        return problem.empty() && !passes.empty() && (!shown || shown->revision != revision);
    }
    bool is_complete() const { return shown && shown->complete && shown->revision == revision; }
};

// Whether a picture of 1/`scale` of its size still has 16 pixels a side.
bool has_coarse_pass(const view::View& view, std::uint32_t scale);
// The passes of a view: 1/8, 1/4 and 1/2 of its size, each where there is one and it is not coarser than
// 1/`coarsest`, then the whole.
std::vector<LivePass> passes_of(const LiveView& view, std::uint32_t coarsest = 8);

inline constexpr std::uint64_t UnitsPerPass = std::uint64_t{1} << 32;
inline constexpr std::size_t MaxPasses = 4;
// Units and views of live scenes have ids that no job uses.
inline constexpr UnitId FirstLiveUnit{std::uint64_t{1} << 63};
inline constexpr ViewId FirstLiveView{std::uint64_t{1} << 48};

}  // namespace tessera::master
