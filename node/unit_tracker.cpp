#include "node/unit_tracker.h"

#include <algorithm>

#include "mediator/net/channel.h"

namespace tessera::node {

namespace {

constexpr std::size_t MaxViews = 256;
constexpr std::uint32_t MaxBlockLevel = 24;
constexpr Duration MaxHold = std::chrono::seconds(10);
constexpr std::size_t MaxHeldUnits = 256;
constexpr std::size_t UnitsInGoodbye = 1024;
constexpr std::size_t FilmLimit = net::BulkLimit - 4096;  // without the header of a film part

std::optional<std::string> fault(const view::View& view, const backend::Capabilities& offered) {
    const Rect picture{0, 0, static_cast<std::int32_t>(view.width), static_cast<std::int32_t>(view.height)};
    if (view.width == 0 || view.height == 0 || view.width > 65536 || view.height > 65536)
        return "its size is out of range";
    if (view.window.empty() || !(intersection(view.window, picture) == view.window))
        return "its window is not inside the picture";
    if (view.channels.empty()) return "it requests no channel";
    if (!offered.channels.contains(view.channels))
        return "it requests a channel that this back-end does not have";
    if (!offered.renderers.contains(view.renderer))
        return "it requests the renderer " + std::string(view::renderer_name(view.renderer)) +
               ", which this back-end does not have";
    return std::nullopt;
}

}  // namespace

UnitTracker::UnitTracker(std::uint32_t workers, const backend::Capabilities& capabilities,
                         const SceneReplica& replica, Effects& effects)
    : capabilities_(capabilities), replica_(replica), effects_(effects), queue_(workers) {}

void UnitTracker::welcomed(std::uint64_t epoch) {
    epoch_ = epoch;
    queue_.restart_sequence();
}

void UnitTracker::open(const wire::OpenView& open) {
    if (const auto why = fault(open.view, capabilities_)) {
        const std::string text =
            "view " + std::to_string(open.view.id.value) + " cannot be rendered: " + *why;
        effects_.send(wire::Notice{wire::Severity::Error, text});
        return effects_.report(wire::Severity::Error, text);
    }
    const auto known = views_.find(open.view.id);
    if (known == views_.end() && views_.size() >= MaxViews) {
        return effects_.report(wire::Severity::Error, "the master opened more than " +
                                                          std::to_string(MaxViews) + " views; close some");
    }
    if (known != views_.end() && known->second.view.revision >= open.view.revision)
        return;  // a delayed older revision
    views_[open.view.id] = {open.view, std::min(open.hold_film, MaxHold)};
    release_waiting(wire::ReleaseReason::Cancelled, "the view has a newer revision", open.view.id);
    release_held(open.view.id, "the view has a newer revision");
    stop_of(open.view.id);
}

void UnitTracker::close(const wire::CloseView& close) {
    if (views_.erase(close.view) == 0) return;
    release_waiting(wire::ReleaseReason::Cancelled, "the view was closed", close.view);
    release_held(close.view, "the view was closed");
    stop_of(close.view);
}

void UnitTracker::work(const wire::Work& work, bool leaving) {
    switch (queue_.admit(work.sequence, work.unit)) {
        case WorkQueue::AdmitResult::Duplicate:
            effects_.state_changed = true;  // the sequence number may be new
            return;
        case WorkQueue::AdmitResult::Full:
            effects_.state_changed = true;
            ++effects_.counters.units_released;
            return effects_.send(
                wire::UnitReleased{work.unit.id, wire::ReleaseReason::Cancelled, "no free slot"});
        case WorkQueue::AdmitResult::Accepted:
            effects_.state_changed = true;
            break;
    }
    if (leaving) return release(work.unit.id, wire::ReleaseReason::Leaving, "the node leaves");
    if (const auto why = objection(work.unit)) release(work.unit.id, why->first, why->second);
}

std::optional<std::pair<wire::ReleaseReason, std::string>> UnitTracker::objection(
    const view::WorkUnit& unit) const {
    using ReleaseCause = std::pair<wire::ReleaseReason, std::string>;
    const auto view = views_.find(unit.view);
    if (view == views_.end())
        return ReleaseCause{wire::ReleaseReason::UnknownView, "the view was never opened"};
    const view::View& opened = view->second.view;
    if (opened.revision != unit.revision) {
        return ReleaseCause{wire::ReleaseReason::UnknownView,
                            "the view is at revision " + std::to_string(opened.revision)};
    }
    const bool is_present = unit.version == replica_.version() && !replica_.is_building();
    const bool will_come = unit.version.epoch == epoch_ && unit.version.number > replica_.version().number &&
                           unit.version.number <= replica_.announced().number;
    if (!is_present && !will_come) {
        return ReleaseCause{wire::ReleaseReason::OtherVersion,
                            "the node is at version " + std::to_string(replica_.version().number)};
    }
    const std::size_t film = unit.tile.pixel_count() * 4 * (1 + opened.channels.plane_count());
    if (unit.tile.empty() || !(intersection(unit.tile, opened.window) == unit.tile) || film > FilmLimit) {
        return ReleaseCause{wire::ReleaseReason::Failed,
                            "its tile is empty, outside the view, or too large for one message of film"};
    }
    if (!unit.block.is_aligned() || unit.block.level > MaxBlockLevel) {
        return ReleaseCause{
            wire::ReleaseReason::Failed,
            "its samples are not an aligned block of at most 2^" + std::to_string(MaxBlockLevel)};
    }
    return std::nullopt;
}

void UnitTracker::cancel(const wire::CancelUnits& cancel) {
    for (const UnitId unit : cancel.units) {
        if (queue_.is_waiting(unit)) {
            release(unit, wire::ReleaseReason::Cancelled, "cancelled");
        } else if (queue_.is_rendering(unit)) {
            stop(unit, wire::ReleaseReason::Cancelled);
        } else if (auto held = held_.take(unit)) {
            // The master may still need the others that it is merged with.
            if (held->units.size() == 1) {
                release(unit, wire::ReleaseReason::Cancelled, "cancelled");
            } else {
                send_held(*std::move(held));
            }
        } else if (queue_.is_sending(unit)) {
            effects_.add(WithdrawFilm{unit});
        }
    }
}

void UnitTracker::release(UnitId unit, wire::ReleaseReason reason, std::string message) {
    queue_.release(unit);
    effects_.state_changed = true;
    ++effects_.counters.units_released;
    effects_.add(Report{.text = "unit is released: " + message, .about = {.unit = unit}, .is_detail = true});
    effects_.send(wire::UnitReleased{unit, reason, std::move(message)});
}

void UnitTracker::release_waiting(wire::ReleaseReason reason, const std::string& message, ViewId of_view) {
    for (const view::WorkUnit& unit : queue_.waiting()) {
        if (!of_view || unit.view == of_view) release(unit.id, reason, message);
    }
}

void UnitTracker::release_held(ViewId view, const std::string& message) {
    for (const HeldFilm::Item& item : held_.take_view(view)) {
        for (const UnitId unit : item.units) release(unit, wire::ReleaseReason::Cancelled, message);
    }
}

void UnitTracker::stop_of(ViewId view) {
    for (const view::WorkUnit& unit : queue_.rendering()) {
        if (unit.view == view) stop(unit.id, wire::ReleaseReason::Cancelled);
    }
}

void UnitTracker::hand_back() {
    for (const view::WorkUnit& unit : queue_.rendering()) stop(unit.id, wire::ReleaseReason::Leaving);
}

void UnitTracker::stop_all() {
    for (const view::WorkUnit& unit : queue_.rendering()) effects_.add(StopUnit{unit.id});
}

void UnitTracker::version_ends() {
    for (const view::WorkUnit& unit : queue_.waiting()) {
        if (unit.version == replica_.version()) {
            release(unit.id, wire::ReleaseReason::OtherVersion, "the node moves on to another version");
        }
    }
}

void UnitTracker::recheck_waiting() {
    for (const view::WorkUnit& unit : queue_.waiting()) {
        if (const auto why = objection(unit)) release(unit.id, why->first, why->second);
    }
}

std::vector<UnitId> UnitTracker::in_flight() const {
    std::vector<UnitId> units = queue_.in_flight();
    std::erase_if(units, [&](UnitId unit) { return abandoned_.contains(unit); });
    return units;
}

void UnitTracker::stop(UnitId unit, wire::ReleaseReason reason) {
    if (stopping_.try_emplace(unit, reason).second) effects_.add(StopUnit{unit});
}

void UnitTracker::abandon() {
    for (const view::WorkUnit& unit : queue_.waiting()) queue_.release(unit.id);
    for (const view::WorkUnit& unit : queue_.rendering()) {
        abandoned_.insert(unit.id);
        stop(unit.id, wire::ReleaseReason::Cancelled);
    }
    for (const UnitId unit : queue_.in_flight()) {
        if (!queue_.is_rendering(unit)) queue_.release(unit);
    }
    release_after_film_.clear();
    (void)held_.take_all();
    sent_.clear();
    views_.clear();
    effects_.add(DiscardPendingFilm{});
}

void UnitTracker::dispatch() {
    if (replica_.is_building()) return;
    while (const auto unit = queue_.next(replica_.version())) {
        effects_.trace(*unit, "unit is being rendered");
        effects_.add(Render{views_.at(unit->view).view, *unit});
    }
}

void UnitTracker::finished(UnitId id, UnitOutcome&& outcome, TimePoint now) {
    const std::optional<view::WorkUnit> unit = queue_.rendered(id);
    if (!unit) return;
    effects_.state_changed = true;
    for (const frame::FilmTile& block : outcome.result.blocks) {
        effects_.counters.samples += block.block.count() * block.pixel_count();
    }
    const auto stopped = stopping_.extract(id);
    if (abandoned_.erase(id) != 0) {
        queue_.release(id);
    } else if (!outcome.error.empty()) {
        release(id, wire::ReleaseReason::Failed, outcome.error);
        effects_.add(Report{wire::Severity::Error,
                            outcome.error,
                            {.view = unit->view, .unit = id, .version = unit->version}});
    } else if (outcome.result.status == backend::RenderStatus::Refused) {
        release(id, wire::ReleaseReason::OtherVersion, "the back-end is at another version");
    } else {
        const auto view = views_.find(unit->view);
        const bool wanted = view != views_.end() && view->second.view.revision == unit->revision;
        const bool whole =
            outcome.result.status == backend::RenderStatus::Done && outcome.result.blocks.size() == 1;
        const auto reason = stopped ? stopped.mapped() : wire::ReleaseReason::Cancelled;
        if (!wanted || outcome.result.blocks.empty()) {
            release(id, reason, "stopped");
        } else if (whole) {
            effects_.trace(*unit, "unit is rendered");
            queue_.hold(id);
            held_.add({.unit = unit->id,
                       .view = unit->view,
                       .revision = unit->revision,
                       .version = unit->version,
                       .rays = outcome.result.rays,
                       .busy_ns = static_cast<std::uint64_t>(outcome.busy.count()),
                       .film = std::move(outcome.result.blocks.front())},
                      now);
            send_ready(now);
        } else {
            release_after_film_.emplace(
                id, wire::UnitReleased{id, reason, "stopped; its whole blocks were sent"});
            send_parts(*unit, std::move(outcome));
        }
    }
}

void UnitTracker::send_ready(TimePoint now) {
    if (held_.empty()) return;
    const auto is_coming = [&](const wire::FilmPart& film) {
        const auto in_other_half = [&](const view::WorkUnit& unit) {
            return !stopping_.contains(unit.id) && is_in_other_half(film, unit);
        };
        const std::vector<view::WorkUnit> waiting = queue_.waiting(), rendering = queue_.rendering();
        return std::any_of(waiting.begin(), waiting.end(), in_other_half) ||
               std::any_of(rendering.begin(), rendering.end(), in_other_half);
    };
    for (HeldFilm::Item& item : held_.take_ready(
             is_coming, [&](ViewId view) { return hold_limit(view); }, now))
        send_held(std::move(item));
    if (held_.unit_count() > MaxHeldUnits) send_all_held();
}

std::optional<TimePoint> UnitTracker::next_event() const {
    return held_.next_event([&](ViewId view) { return hold_limit(view); });
}

Duration UnitTracker::hold_limit(ViewId view) const {
    const auto opened = views_.find(view);
    return opened == views_.end() ? Duration::zero() : opened->second.hold_film;
}

void UnitTracker::send_all_held() {
    for (HeldFilm::Item& item : held_.take_all()) send_held(std::move(item));
}

void UnitTracker::send_held(HeldFilm::Item&& item) {
    for (const UnitId unit : item.units) queue_.unhold(unit);
    SendFilm film{std::move(item.units), {}};
    film.parts.push_back(std::move(item.film));
    effects_.add(std::move(film));
}

// The whole blocks of a stopped unit.
void UnitTracker::send_parts(const view::WorkUnit& unit, UnitOutcome&& outcome) {
    SendFilm film{{unit.id}, {}};
    for (frame::FilmTile& block : outcome.result.blocks) {
        const bool is_first = film.parts.empty();
        film.parts.push_back({.unit = unit.id,
                              .view = unit.view,
                              .revision = unit.revision,
                              .version = unit.version,
                              .units = 0,
                              .rays = is_first ? outcome.result.rays : 0,
                              .busy_ns = is_first ? static_cast<std::uint64_t>(outcome.busy.count()) : 0,
                              .film = std::move(block)});
    }
    effects_.add(std::move(film));
}

void UnitTracker::film_withdrawn(UnitId unit) {
    release_after_film_.erase(unit);
    release(unit, wire::ReleaseReason::Cancelled, "cancelled");
}

void UnitTracker::film_sent(UnitId unit) {
    effects_.state_changed = true;
    effects_.add(Report{.text = "film of the unit is sent", .about = {.unit = unit}, .is_detail = true});
    queue_.release(unit);
    if (const auto release = release_after_film_.extract(unit)) {
        ++effects_.counters.units_released;
        return effects_.send(std::move(release.mapped()));
    }
    ++effects_.counters.units_done;
    sent_.push_back(unit);
    if (sent_.size() > UnitsInGoodbye) sent_.pop_front();
}

}  // namespace tessera::node
