// What a scene session does on the scene authority, in the event loop or on the authority's thread.
#include <algorithm>
#include <exception>

#include "master/render/adaptive/saved_step.h"
#include "master/render/earlier_film.h"
#include "master/scene_session.h"
#include "mediator/wire/envelope.h"

namespace tessera::master {

namespace {

// Messages that read or change what belongs to the authority, or its journal.
template <class... Types>
bool is_one_of(const wire::ControlMessage& message) {
    return (std::holds_alternative<Types>(message) || ...);
}

}  // namespace

bool SceneSession::waits(const SessionRecord& session, const wire::ControlMessage& message) const {
    if (std::holds_alternative<wire::Heartbeat>(message)) return false;
    // Edits that were sent before are applied first.
    if (std::holds_alternative<wire::Goodbye>(message) && session.edits_wait) return true;
    if (!is_editing()) return false;
    if (requester_ == session.id) return true;
    // Other members' views open and move on while an edit is applied.
    if (const auto* view = std::get_if<wire::RequestView>(&message)) {
        const bool is_open = views_.watched(session.id, view->number).has_value();
        return view->wanted.detached || view->wanted.frames == session::Frames::Last ||
               (!is_open && session.edits_wait);
    }
    return is_one_of<wire::JoinScene, wire::CloseScene, wire::ReadScene, wire::LockObjects, wire::ReadMembers,
                     wire::ReadHistory, wire::ReadWriters, wire::CancelJob>(message);
}

void SceneSession::run(const Cost& cost, std::function<void(SceneAuthority&)> work,
                       std::function<void(TimePoint)> then, TimePoint now) {
    const auto failed = std::make_shared<std::exception_ptr>();
    const auto finish = [this, failed, then = std::move(then)](TimePoint at) {
        requester_.reset();
        transactions_ = authority_.transactions();
        if (journal_) journal_bytes_ = journal_->byte_size();
        if (!*failed) then(at);
        catch_up_with_edits(at);
        if (*failed) std::rethrow_exception(*failed);  // to the loop's guard, as if it had happened there
    };
    if (cost.objects <= SceneEncoder::ShortList && !(cost.writes && journal_)) {
        work(authority_);
        return finish(now);
    }
    const auto guarded = [this, failed, work = std::move(work)] {
        try {
            work(authority_);
        } catch (...) {
            *failed = std::current_exception();
        }
    };
    thread_.run(guarded, finish);
}

// What came up while the authority was on its thread.
void SceneSession::catch_up_with_edits(TimePoint now) {
    if (is_editing()) return;
    for (const SessionId session : std::exchange(to_forget_, {})) authority_.forget(session);
    if (const auto eye = std::exchange(to_follow_, std::nullopt); eye && open_) follow(*eye, now);
    if (!is_editing() && !unbuildable_.empty()) withdraw_unbuildable(std::exchange(unbuildable_, {}), now);
}

void SceneSession::forget_editor(SessionId session) {
    if (is_editing()) {
        to_forget_.push_back(session);
    } else {
        authority_.forget(session);
    }
}

void SceneSession::edited(const SessionRecord& session, const scene::Edit& edit, const EditAnswer& answer,
                          std::uint64_t message_bytes, TimePoint now) {
    ++counts_.edits;
    counts_.edit_bytes += message_bytes;
    if (!answer.accepted || answer.transaction == 0) return;
    traces_.submitted({.transaction = answer.transaction,
                       .name = name(session.id),
                       .bytes = message_bytes,
                       .submitted_at = edit.submitted_at,
                       .clock = session.clock.offset(now),
                       .received = now,
                       .version = answer.version});
}

// ---- versions ----

void SceneSession::publish(scene::ChangeList&& published, TimePoint now) {
    const auto shared = std::make_shared<const scene::ChangeList>(std::move(published));
    const scene::ChangeList& changes = *shared;
    PublishedScene before = std::exchange(published_, authority_.published());
    published_at_ = now;
    unpublished_since_.reset();
    ++counts_.versions;
    published_transactions_ = authority_.transactions();
    // Outdated work is cancelled before the change is sent to the nodes, so that they build sooner.
    const bool restarts = views_.scene_changed(changes, published_.scene());
    const std::uint64_t sent_before = services_.outbox.bytes.control;
    distributor_.published(services_.nodes, shared, now);
    counts_.change_bytes += services_.outbox.bytes.control - sent_before;
    traces_.published(changes.to, now);
    if (display_.scene_changed(changes)) follow_display(now);
    if (views_.table().all().empty()) {
        traces_.no_open_views();
    } else if (!restarts) {
        traces_.merged(changes.to, now);  // the existing pictures show it
    }
    if (changes.entries.size() > SceneEncoder::ShortList) discard(std::pair(shared, std::move(before)));
}

void SceneSession::publish_edits(std::function<void(TimePoint)> then, TimePoint now) {
    const auto changes = std::make_shared<std::optional<scene::ChangeList>>();
    run(
        {.objects = authority_.unpublished_objects()},
        [changes](SceneAuthority& authority) { *changes = authority.publish(); },
        [this, changes, then = std::move(then)](TimePoint at) {
            if (*changes) publish(std::move(**changes), at);
            views_.pause_passes(false);
            then(at);
        },
        now);
}

void SceneSession::publish_if_due(TimePoint now) {
    if (is_editing()) return;
    const bool waits = authority_.has_unpublished();
    views_.pause_passes(waits);
    if (!waits) {
        unpublished_since_.reset();
        return;
    }
    if (!unpublished_since_) unpublished_since_ = now;
    if (now - published_at_ < VersionInterval) return;
    if (now - *unpublished_since_ < FirstFrameWait && !views_.may_publish()) return;
    publish_edits([](TimePoint) {}, now);
}

// The render origin follows the display while there are no other views.
void SceneSession::follow_display(TimePoint now) {
    const auto& views = views_.table().all();
    if (!std::all_of(views.begin(), views.end(), [](const auto& entry) { return entry.second.in_group(); }))
        return;
    if (const auto head = display_.head_in_world()) follow(*head, now);
}

void SceneSession::follow(const glm::dvec3& eye, TimePoint now, std::function<void(TimePoint)> then) {
    if (is_editing()) {
        to_follow_ = eye;
        return;
    }
    if (authority_.is_near_origin(eye)) {
        if (then) then(now);
        return;
    }
    const auto moved = std::make_shared<std::optional<scene::ChangeList>>();
    run(
        {authority_.unpublished_objects(), true},
        [moved, eye](SceneAuthority& authority) { *moved = authority.follow_camera(eye); },
        [this, moved, then = std::move(then)](TimePoint at) {
            if (*moved) publish(std::move(**moved), at);
            if (then) then(at);
        },
        now);
}

// ---- versions that no node can build ----

void SceneSession::node_refused(NodeRecord& node, const wire::SceneRefused& refusal, TimePoint now) {
    distributor_.refused(node, refusal);
    if (node.refused != published_.version()) return;
    if (!open_ || is_exclusive()) return;
    bool any = false;
    for (const auto& [id, other] : services_.nodes.all()) {
        if (other.leaving) continue;
        if (other.refused != published_.version()) return;  // it may still build it
        any = true;
    }
    if (any) withdraw_unbuildable("node " + node.hello.name + ": " + refusal.reason, now);
}

void SceneSession::withdraw_unbuildable(const std::string& reason, TimePoint now) {
    if (is_editing()) {
        unbuildable_ = reason;
        return;
    }
    const auto withdrawn = std::make_shared<std::vector<SceneAuthority::Withdrawn>>();
    const auto work = [withdrawn, from = built_transactions_,
                       to = published_transactions_](SceneAuthority& authority) {
        // Later edits have not been tried; one of them may be the remedy.
        *withdrawn = authority.withdraw(from, to, {.name = "the master"});
    };
    const auto then = [this, withdrawn, reason](TimePoint at) {
        for (const SceneAuthority::Withdrawn& edit : *withdrawn) {
            const std::string text = "edit " + std::to_string(edit.transaction) + " (" + edit.text +
                                     ") is undone, since no node can build the scene with it: " + reason;
            services_.events({wire::Severity::Error, text});
            if (const SessionRecord* author = services_.sessions.find(edit.author))
                services_.outbox.control(author->control, wire::Notice{wire::Severity::Error, text});
        }
        publish_if_due(at);
    };
    run({published_.scene().objects().size(), true}, work, then, now);
}

// ---- views ----

void SceneSession::handle(SessionRecord& session, const wire::RequestView& request, TimePoint now,
                          std::optional<frame::FilmState>&& film) {
    if (request.share)
        return view_opened(session.id, request, views_.share(session.id, request.number, request.wanted));
    if (std::string problem = view_problem(session, request.number, request.wanted); !problem.empty())
        return view_opened(session.id, request, problem);
    // Earlier edits are visible in the view, and the render origin follows the camera while it is the only one.
    const SessionId id = session.id;
    const auto earlier = std::make_shared<std::optional<frame::FilmState>>(std::move(film));
    const auto open = [this, id, request, earlier](TimePoint at) {
        open_view(id, request, std::move(*earlier), at);
    };
    const auto follow_and_open = [this, id, request, open](TimePoint at) {
        if (views_.table().all().size() > 1) return open(at);
        requester_ = id;
        follow(glm::dvec3(request.wanted.view.camera.world_from_camera[3]), at, open);
    };
    const bool waits_for_end = request.wanted.frames == session::Frames::Last || request.wanted.detached;
    if (!waits_for_end) publish_if_due(now);
    if (is_editing()) {
        // It opens at the version there is; what is being edited restarts it.
        if (views_.table().all().size() <= 1)
            to_follow_ = glm::dvec3(request.wanted.view.camera.world_from_camera[3]);
        return open(now);
    }
    if (!waits_for_end || !authority_.has_unpublished() || !views_.may_publish()) return follow_and_open(now);
    requester_ = id;
    publish_edits(follow_and_open, now);
}

std::string SceneSession::view_problem(const SessionRecord& session, std::uint64_t number,
                                       const session::ViewRequest& wanted) const {
    if (wanted.detached) {
        if (std::string problem = submission_problem(session, wanted); !problem.empty()) return problem;
    }
    if (std::string problem = problem_of(wanted); !problem.empty()) return problem;
    if (std::string problem = viewer_problem(session, number, wanted); !problem.empty()) return problem;
    session::ViewRequest completed = wanted;
    complete(completed);
    return memory_problem(completed, views_.watched(session.id, number));
}

std::string SceneSession::film_problem(const wire::EarlierFilm& film) const {
    if (film.render_revision != frame::RenderRevision) {
        return "its film is of render revision " + std::to_string(film.render_revision) +
               ", and this master's nodes render " + std::to_string(frame::RenderRevision) +
               ": continue it with the build that rendered it";
    }
    if (film.scene_hash != published_.state_hash()) {
        return "its film shows another scene: name the file of that scene, and give the options that change "
               "the "
               "scene as they were then, such as --env, --material, --hide, --at";
    }
    return {};
}

void SceneSession::open_view(SessionId id, const wire::RequestView& request,
                             std::optional<frame::FilmState>&& film, TimePoint now) {
    requester_.reset();
    const SessionRecord* session = services_.sessions.find(id);
    if (session == nullptr || !is_member(id)) return;  // it has left
    const ViewOwner owner{id, name(id), session->user, members_.at(id).key};
    Views::Continued continued;
    if (film) {
        std::string problem = film_problem(*request.earlier);
        session::ViewRequest completed = request.wanted;
        complete(completed);
        if (problem.empty()) problem = problem_of(*film, completed);
        if (!problem.empty()) return view_opened(id, request, problem);
        continued = {EarlierFilm{std::move(film->blocks), film->steps, saved_step(film->wanted)},
                     request.wanted.reproducible ? request.earlier->kind : std::string()};
    }
    const std::string problem =
        views_.open(owner, request.number, request.wanted, {published_.version(), published_.state_hash()},
                    now, std::move(continued));
    if (problem.empty() && request.wanted.detached) return record_job(id, request, now);
    view_opened(id, request, problem);
}

void SceneSession::view_opened(SessionId id, const wire::RequestView& request, const std::string& problem) {
    const SessionRecord* session = services_.sessions.find(id);
    if (!session || (request.request == 0 && problem.empty())) return;
    const bool unavailable = !problem.empty() && problem == why_unavailable(request.wanted.view);
    services_.outbox.control(session->control,
                             wire::RequestDone{request.request, problem.empty(), problem, unavailable});
}

}  // namespace tessera::master
