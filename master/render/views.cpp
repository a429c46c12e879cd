#include "master/render/views.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "master/filter/catalog.h"
#include "master/render/picture_effect.h"
#include "mediator/filter/choice.h"

namespace tessera::master {

namespace {
constexpr std::uint64_t MaxFilmBytes = std::uint64_t{128}
                                       << 20;  // per frame, of a view that streams its film

bool differ_in_filter_alone(view::View a, view::View b) {
    a.filter.clear();
    b.filter.clear();
    return a == b;
}

// With the other filter, instead of from the start. Pixels with different numbers of samples cannot get further channels.
bool goes_on(const ViewState& view, const FilterChange& change) {
    if (change.effect != FilterChange::Effect::Widened) return change.effect == FilterChange::Effect::Kept;
    const bool has_equal_samples = view.run.steps == 0 && !view.run.is_deciding;
    return !view.run.outcome && (!view.request.has_steps() || has_equal_samples || view.run.is_widened);
}

bool may_change(const SessionRecord& asker, const ViewState& view) {
    return view.owner.session == asker.id || view.owner.user == asker.user ||
           asker.role == net::Role::Operator;
}

}  // namespace

Views::Views(const ViewSettings& settings, const RenderServices& services, SessionTable& sessions,
             Outbox& outbox, const EventSink& events, std::function<std::string(ObjectId)> name_of)
    : settings_(settings),
      services_(services),
      table_(services.ids),
      passes_{services.dispatcher, services.film},
      delivery_(table_, sessions, outbox, services.film),
      runner_(settings_, table_, passes_, delivery_, sessions, outbox, events),
      group_(table_, passes_),
      picks_(services.ids, passes_, sessions, outbox, std::move(name_of)),
      saver_(table_, passes_) {}

// ---- clients ----

std::string Views::share(SessionId session, std::uint64_t number, const session::ViewRequest& wanted) {
    const ViewState* view = table_.named(wanted.name);
    if (view == nullptr) return "no view is named '" + wanted.name + "': list the views to see their names";
    if (std::string problem = problem_of(wanted.display_transform); !problem.empty()) return problem;
    delivery_.watch(session, number, view->id, format_of(wanted));
    return {};
}

std::string Views::open(const ViewOwner& owner, std::uint64_t number, session::ViewRequest request,
                        const SceneInFilm& scene, TimePoint now, Continued&& continued) {
    if (std::string problem = problem_of(request); !problem.empty()) return problem;
    session::ViewRequest completed = request;
    complete(completed);
    const std::uint64_t bytes = film_bytes(completed.view);
    if (request.film && request.frames == session::Frames::All && bytes > MaxFilmBytes) {
        return "the statistics of this view have " + std::to_string(bytes >> 20) +
               " MiB a frame, more than 128: ask for a picture, fewer channels or a smaller window";
    }
    if (request.name.empty()) request.name = name_of_unnamed(owner, number);
    std::string problem;
    ViewState* view = find_or_add(owner, number, request.name, problem);
    if (view == nullptr) return problem;
    if (view->asked_revision != 0 && view->request.detached != request.detached)
        return "a view cannot become a job, or stop being one: close it, or cancel the job, first";
    view->owner = owner;
    view->name = request.name;
    view->orphaned.reset();
    const Delivery::FrameFormat format = format_of(request);
    // Ended views do not follow the scene, and who has one's end wants another.
    const bool again = view->has_ended() &&
                       (view->version != scene.version || delivery_.has_taken_end(owner.session, number));
    delivery_.watch(owner.session, number, view->id, format);
    if (request.detached) {
        delivery_.keep(view->id, format);  // its end is for take_ended_jobs()
    } else {
        delivery_.release(view->id);  // its owner is back
    }
    if (view->asked_revision == 0 && continued.film) {
        view->earlier = std::move(continued.film);
        view->earlier_kind = std::move(continued.kind);
    }
    change(*view, std::move(request), scene, again, now);
    return {};
}

// The view of this number, or the owner's orphaned view of this name, or a new one.
ViewState* Views::find_or_add(const ViewOwner& owner, std::uint64_t number, const std::string& name,
                              std::string& problem) {
    const auto watched = delivery_.watched(owner.session, number);
    ViewState* view = watched ? table_.find(*watched) : nullptr;
    const auto is_owner = [&](const ViewState& other) {
        return other.owner.user == owner.user && other.owner.key == owner.key;
    };
    if (ViewState* known = table_.named(name); known != nullptr && known != view) {
        if (!known->orphaned || !is_owner(*known)) {
            problem = "a view named '" + name + "' already exists: choose another name, or share it";
            return nullptr;
        }
        view = known;
    }
    // Who watches the view of another, even of one that was lost, gets a view of its own.
    if (view != nullptr && view->owner.session != owner.session && !(view->orphaned && is_owner(*view)))
        view = nullptr;
    if (view != nullptr) return view;
    const std::size_t count = table_.all().size() - group_.views().size();
    if (count >= settings_.max_views) {
        problem = "there are " + std::to_string(count) + " views, the maximum: close some";
        return nullptr;
    }
    return &table_.add();
}

void Views::change(ViewState& view, session::ViewRequest&& request, const SceneInFilm& scene, bool again,
                   TimePoint now) {
    const view::View asked = std::exchange(view.asked, request.view);
    complete(request);
    request.view.id = view.request.view.id;
    request.view.revision = view.request.view.revision;
    const bool is_new = view.asked_revision == 0;
    const bool same_terms = !is_new && request.stop == view.request.stop &&
                            request.frames == view.request.frames && request.policy == view.request.policy &&
                            request.reproducible == view.request.reproducible &&
                            request.tile == view.request.tile;
    view.request.detached = request.detached;
    view.request.picture = request.picture;
    view.request.film = request.film;
    view.request.film_state = request.film_state;
    view.request.display_transform = request.display_transform;
    view.request.min_nodes = request.min_nodes;
    view.request.wait_limit = request.wait_limit;
    if (same_terms && !again && request.view == view.request.view) return;
    ++view.asked_revision;
    if (same_terms && !again && !view.restart_wanted && differ_in_filter_alone(asked, view.asked)) {
        const FilterChange change = filter_change(view.request.view, request.view.filter);
        if (goes_on(view, change)) {
            view.camera_revision = view.asked_revision;
            return runner_.change_filter(view, change, now);
        }
    }
    view.request = std::move(request);
    view.problem.clear();
    if (is_new) view.waits_since = now;
    const bool wait = view.awaiting_first_frame();
    view.restart_wanted = true;
    if (!wait) passes_.end_all(view);
    view.version = scene.version;
    view.scene_hash = scene.hash;
}

void Views::end(SessionId session, const wire::EndView& request, TimePoint now) {
    const auto watched = delivery_.watched(session, request.number);
    if (!request.deliver) {
        delivery_.leave(session, request.number);
        if (watched && delivery_.watchers(*watched) == 0 && !table_.find(*watched)->in_group())
            remove(*watched);
        return;
    }
    ViewState* view = watched ? table_.find(*watched) : nullptr;
    if (view != nullptr && view->owner.session == session && !view->in_group())
        runner_.decide(*view, session::Outcome::Stopped, "stopped by the client", now);
}

std::string Views::job_problem(const session::ViewRequest& request) {
    if (request.name.empty()) return "a job needs a name";
    if (request.frames != session::Frames::Last) return "a job has one frame, its last";
    if (request.film) return "the film of a job is not kept: request only its picture";
    if (request.picture == session::PictureEncoding::None) return "a job needs a picture: request one";
    return {};
}

void Views::release(ViewId view) {
    delivery_.release(view);
    if (delivery_.watchers(view) == 0) remove(view);
}

bool Views::has_jobs() const {
    return std::any_of(table_.all().begin(), table_.all().end(),
                       [this](const auto& entry) { return is_job(entry.first); });
}

// The view of that name; without a name the only one, preferring those of the asker, and views that a client waits for.
ViewState& Views::view_to_filter(const SessionRecord& asker, const std::string& name) {
    const auto refuse = [](const std::string& why) { throw Error(ErrorCode::Refused, why); };
    std::vector<ViewState*> waited, shown;
    for (auto& [id, view] : table_.all()) {
        if (view.in_group() || (!name.empty() && view.name != name)) continue;
        if (view.shows_all()) {
            shown.push_back(&view);
        } else if (!view.run.outcome) {
            waited.push_back(&view);
        }
    }
    auto& candidates = waited.empty() ? shown : waited;
    const auto is_changeable = [&](const ViewState* view) { return may_change(asker, *view); };
    if (std::ranges::any_of(candidates, is_changeable)) std::erase_if(candidates, std::not_fn(is_changeable));
    if (candidates.empty() && !name.empty())
        refuse("no view named '" + name + "' is being rendered: ask for the views that there are");
    if (candidates.empty()) refuse("no frame is being rendered: try again when one is");
    if (candidates.size() > 1)
        refuse("there are " + std::to_string(candidates.size()) + " views: name one of them with --view");
    const ViewState& view = *candidates.front();
    if (!is_changeable(&view)) {
        refuse("view '" + view.name + "' belongs to " + view.owner.name + " (key " + view.owner.user +
               "): only that key or an operator's may change its filter; open a view of your own");
    }
    return *candidates.front();
}

std::string Views::set_filter(const SessionRecord& asker, const std::string& name, const std::string& filter,
                              const RoomProblem& room_problem, TimePoint now) {
    const auto refuse = [](const std::string& why) { throw Error(ErrorCode::Refused, why); };
    const auto choice = filter::parse_choice(filter, filter::catalog());
    if (!choice) refuse(choice.error().what());
    if (const std::string why = filter::why_unavailable(*choice->entry); !why.empty())
        throw Error(ErrorCode::Unavailable, why);
    ViewState& view = view_to_filter(asker, name);
    if (view.request.reproducible) {
        if (const std::string why = filter::why_not_reproducible(*choice->entry); !why.empty()) refuse(why);
    }
    if (view.request.stop.error > 0.0) {
        if (const std::string why = filter::why_no_error_estimate(*choice); !why.empty())
            refuse("the frame ends at an error of its picture, which cannot be estimated: " + why);
    }
    if (view.request.picture == session::PictureEncoding::None) {
        refuse(
            "the frame's client requested only the film: nothing would be filtered; start it with "
            "--filter");
    }
    const FilterChange change = filter_change(view.request.view, filter);
    session::ViewRequest wanted = view.request;
    wanted.view = change.view;
    if (const std::string why = room_problem(wanted, view.id); !why.empty()) refuse(why);
    if (view.shows_all()) {
        const bool restarts = !goes_on(view, change);
        wanted.view = view.asked;
        wanted.view.filter = filter;
        this->change(view, std::move(wanted), {view.version, view.scene_hash}, false, now);
        if (restarts)
            return "filter " + change.view.filter +
                   "; the view restarts, since the filter needs other channels or path classes";
        return change.text;
    }
    const bool has_features_first = !view.passes.empty() && !view.is_last_pass();
    if (has_features_first) refuse("the frame has just begun: try again in a moment");
    if (change.effect == FilterChange::Effect::Restarted) refuse(change.text);
    if (change.effect == FilterChange::Effect::Widened && view.request.has_steps()) {
        refuse("filter '" + filter +
               "' needs channels that this frame lacks, and one whose pixels have the samples that they need "
               "gets no "
               "more of them: start it with the filter");
    }
    runner_.change_filter(view, change, now);
    return change.text;
}

void Views::pick(SessionId session, const wire::Pick& request, Version version) {
    const auto watched = delivery_.watched(session, request.number);
    const ViewState* view = watched ? table_.find(*watched) : nullptr;
    picks_.pick(session, request, view == nullptr ? nullptr : &view->request.view, version);
}

void Views::remove(ViewId id) {
    ViewState* view = table_.find(id);
    if (view == nullptr) return;
    passes_.end_all(*view);
    delivery_.forget(id);
    services_.film.forget(id, ViewId{id.value + MaxPasses});
    table_.erase(id);
}

void Views::close_all() {
    close_group();
    while (!table_.all().empty()) remove(table_.all().begin()->first);
    picks_.close_all();
}

// ---- scene ----

bool Views::may_publish() const {
    return std::none_of(table_.all().begin(), table_.all().end(), [this](const auto& entry) {
        const ViewState& view = entry.second;
        // Without a suitable node there is nothing to wait for.
        return view.awaiting_first_frame() &&
               services_.dispatcher
                       .prospects(view.request.view, {view.version, view.request.reproducible, view.run.kind})
                       .suitable > 0;
    });
}

bool Views::scene_changed(const scene::ChangeList& changes, const scene::Scene& after) {
    const PictureEffect effect = picture_effect(changes, after);
    const bool restarts = effect.samples;
    if (effect.lights_or_materials) table_.last_edits.lights_or_materials = changes.to;
    if (effect.geometry) table_.last_edits.geometry = changes.to;
    group_.scene_changed(changes.to, restarts);
    for (auto& [id, view] : table_.all()) {
        if (view.has_ended()) continue;
        view.version = changes.to;
        view.scene_hash = after.state_hash();
        if (restarts) {
            view.earlier.reset();
            view.earlier_kind.clear();
            view.problem.clear();
            view.restart_wanted = true;
            passes_.end_all(view);
        } else {
            for (const Pass& pass : view.passes) services_.dispatcher.follow(pass.view.id, changes.to);
        }
    }
    picks_.follow(changes.to);
    return restarts;
}

// ---- events ----

void Views::took(const MergeReport& report, Dispatcher::Taken taken, TimePoint now) {
    ViewState* view = table_.of_pass(report.view);
    if (view != nullptr && !view->in_group()) runner_.took(*view, report, taken, now);
}

bool Views::take(RenderOutput& output, TimePoint now) {
    if (auto* tile = std::get_if<EncodedTile>(&output)) {
        delivery_.take(std::move(*tile));
    } else if (auto* made = std::get_if<Reconstructed>(&output)) {
        runner_.take(std::move(*made), now);
    } else if (const auto* calibration = std::get_if<CalibrationResult>(&output)) {
        runner_.take(*calibration);
    } else if (auto* decision = std::get_if<StepDecision>(&output)) {
        ViewState* view = table_.of_pass(decision->view);
        if (view == nullptr) return true;
        view->in_group() ? group_.take(*view, std::move(*decision))
                         : runner_.take(*view, std::move(*decision), now);
    } else if (auto* film = std::get_if<FilmBlocks>(&output)) {
        if (!picks_.take(*film)) (void)saver_.take(std::move(*film));
    } else {
        return false;
    }
    return true;
}

std::vector<FirstPicture> Views::take_first_pictures() {
    return runner_.take_first_pictures();
}

// ---- lockstep ----

void Views::close_group() {
    for (const ViewId view : group_.close()) remove(view);
}

void Views::restart_group(const std::vector<GroupView>& wanted, TimePoint now) {
    for (const ViewId view : group_.restart(wanted, now)) remove(view);
}

std::optional<GroupStage> Views::next_group_stage(LockstepGroup::Consumer consumer, TimePoint now) {
    auto stage = group_.advance(consumer);
    if (stage && group_.is_first_stage()) runner_.is_first_picture(stage->scene.version, now);
    return stage;
}

// ---- time ----

void Views::advance(TimePoint now) {
    forget_orphans(now);
    for (auto& [id, view] : table_.all()) {
        // One view that fails takes no other with it.
        try {
            runner_.notify_waiting(view, now);
            if (!view.in_group()) {
                runner_.advance(view, now);
            } else if (!view.passes.empty() && services_.dispatcher.is_superseded(view.pass().view.id)) {
                group_.scene_changed(view.version, true);
            }
        } catch (const std::exception& error) {
            runner_.fail(view, std::string("it could not be rendered: ") + error.what(), now);
        }
    }
}

void Views::deal(TimePoint now) {
    std::vector<NodeCapacity> capacities = services_.dispatcher.capacities();
    picks_.deal(capacities, now);
    services_.dispatcher.deal_verifications(capacities, now);
    std::vector<ViewState*> order;
    for (auto& [id, view] : table_.all()) {
        const bool restarts = !view.in_group() && view.restart_wanted && !table_.passes_paused &&
                              !view.awaiting_first_frame() && view.problem.empty();
        if (restarts) {
            try {
                runner_.restart(view, now);
            } catch (const std::exception& error) {
                runner_.fail(view, std::string("it could not be started: ") + error.what(), now);
            }
        }
        if (!view.passes.empty()) order.push_back(&view);
    }
    if (!order.empty()) {
        // Views without a picture first, then those with the fewest samples; equal views take turns.
        std::rotate(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(turn_++ % order.size()),
                    order.end());
        const auto rank = [this](const ViewState& view) {
            const Pass& pass = view.pass();
            const auto pixels = static_cast<double>(view.request.view.window.pixel_count());
            const auto samples =
                static_cast<double>(services_.dispatcher.find(pass.view.id)->merged_samples());
            const double spp = pass.kind == Pass::Kind::Picture ? samples / pixels / view.priority() : 0.0;
            return std::pair(-static_cast<int>(pass.scale), std::floor(spp));
        };
        std::stable_sort(order.begin(), order.end(),
                         [&](const ViewState* a, const ViewState* b) { return rank(*a) < rank(*b); });
        for (const ViewState* view : order) services_.dispatcher.deal(view->pass().view.id, capacities, now);
    }
    deliver(now);
}

void Views::deliver(TimePoint now) {
    for (auto& [id, view] : table_.all()) {
        delivery_.send_frames(view, now, settings_.frame_interval);
        if (!view.shows_all()) runner_.show_progress(view, now);
    }
    delivery_.send();
    picks_.tick();
}

TimePoint Views::next_event(TimePoint now) const {
    if (delivery_.has_more()) return now;
    TimePoint next = TimePoint::max();
    for (const auto& [id, view] : table_.all()) next = std::min(next, runner_.next_event(view, now));
    if (group_.is_open() || !picks_.empty()) next = std::min(next, now + settings_.frame_interval);
    return next;
}

}  // namespace tessera::master
