#include "master/scene_session.h"

#include <unistd.h>

#include <algorithm>

#include "mediator/wire/envelope.h"

namespace tessera::master {

namespace {

constexpr Duration VersionInterval = std::chrono::milliseconds(16);
constexpr std::size_t MaxNameLength = 64;

std::uint64_t three_quarters_of_memory() {
    return static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
           static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) / 4 * 3;
}

}  // namespace

SceneSession::SceneSession(std::uint64_t epoch, const ViewSettings& settings, const MasterServices& services)
    : services_(services),
      owner_timeout_(settings.orphan_limit),
      memory_limit_(services.memory_limit != 0 ? services.memory_limit : three_quarters_of_memory()),
      authority_(epoch, services.blobs),
      encoder_([&outputs = services.render.outputs](EncodedScene made) { outputs.put(std::move(made)); }),
      distributor_(authority_, encoder_, *services.blobs, services.outbox, services.events),
      reads_(authority_, encoder_, *services.blobs, services.sessions, services.outbox),
      collector_(services.blobs, services.collect_interval),
      views_(settings, services.render, services.sessions, services.outbox, services.events,
             [this](ObjectId id) {
                 const scene::Object* object = authority_.scene().find(id);
                 return object ? scene::name(*object) : std::string();
             }),
      display_(authority_, services.sessions, views_, services.outbox, services.events) {}

std::string SceneSession::unique_name(const std::string& wanted) const {
    const auto taken = [&](const std::string& name) {
        return std::any_of(members_.begin(), members_.end(),
                           [&](const auto& entry) { return entry.second.name == name; });
    };
    std::string base = wanted.empty() ? "client" : wanted.substr(0, MaxNameLength);
    if (!taken(base)) return base;
    for (int number = 2;; ++number) {
        std::string name = base + " (" + std::to_string(number) + ")";
        if (!taken(name)) return name;
    }
}

void SceneSession::open(wire::RecordedTitle scene) {
    if (journal_) journal_->opened(scene);
    open_ = true;
    scene_ = std::move(scene);
    owner_missing_since_.reset();
    views_.charge_from(services_.outbox.bytes);
    counts_ = {};
    traces_ = {};
    published_transactions_ = built_transactions_ = authority_.transactions();
    services_.events(
        {wire::Severity::Info, (is_exclusive() ? "scene '" : "live scene '") + title() + "' is open"});
}

bool SceneSession::admits(const SessionRecord& session, const wire::JoinScene& request) const {
    if (!open_ || request.exclusive != is_exclusive()) return false;
    return !is_exclusive() || is_member(session.id) ||
           (scene_.owner->user == session.user && scene_.owner->key == request.key);
}

void SceneSession::join(SessionRecord& session, const wire::JoinScene& request, TimePoint now) {
    const bool may_edit = session.role != net::Role::Viewer;
    if (may_edit && request.key == 0)
        throw Error(ErrorCode::Refused, "a member key of 0 is not valid: choose a random one");
    if (!may_edit && request.exclusive)
        throw Error(ErrorCode::Refused, "a viewer cannot open a scene: use an editor's key");
    if (!open_) {
        open({.title = request.title.empty() ? "untitled" : request.title,
              .owner = request.exclusive ? std::optional(wire::RecordedOwner{session.user, request.key})
                                         : std::nullopt});
    }
    owner_missing_since_.reset();
    // Viewers need neither ids nor a journal record.
    const IdRange ids = may_edit ? authority_.join(session.id, session.user, request.key) : IdRange{};
    if (may_edit && ids.count == 0) {
        throw Error(
            ErrorCode::Refused,
            "all object ids are allocated, or the session folder cannot be written: see the master's log");
    }
    if (!members_.contains(session.id)) {
        Member& member = members_[session.id];
        member.name = unique_name(request.name);
        member.key = request.key;
        services_.events(
            {wire::Severity::Info, member.name + " (" + session.user + ") joined '" + title() + "'"});
    }
    publish_if_due(now);
    services_.outbox.control(session.control,
                             wire::SceneJoined{.version = authority_.version(),
                                               .first_id = ids.first,
                                               .id_count = ids.count,
                                               .last_sequence = authority_.last_sequence(session.id),
                                               .title = title(),
                                               .name = members_.at(session.id).name});
}

void SceneSession::close(TimePoint now) {
    if (!open_) return;
    open_ = false;
    services_.events(
        {wire::Severity::Info, (is_exclusive() ? "scene '" : "live scene '") + title() + "' is closed"});
    display_.close();
    views_.close_all();
    for (const auto& [id, member] : members_) authority_.forget(id);
    members_.clear();
    reads_.clear();
    if (auto cleared = authority_.clear()) publish(std::move(*cleared), now);
    collector_.scene_closed();
    if (journal_) journal_->closed();
    scene_ = {};
}

void SceneSession::left(SessionId session, Views::DisconnectReason reason, TimePoint now) {
    const auto member = members_.find(session);
    if (member == members_.end()) return;
    services_.events({wire::Severity::Info, member->second.name + " left '" + title() + "'"});
    views_.session_left(session, reason, now);
    display_.left(session, now);
    authority_.release_all(session);
    authority_.forget(session);
    members_.erase(member);
    reads_.left(session);
    if (reason == Views::DisconnectReason::Timeout && members_.empty()) owner_missing_since_ = now;
    close_when_left(now);
}

// An exclusive scene is closed when its owner leaves, unless jobs continue. One that was recovered, or whose owner was
// lost, waits for its owner for a while, but not once it only keeps others waiting.
void SceneSession::close_when_left(TimePoint now) {
    if (!open_ || !is_exclusive() || !members_.empty() || views_.has_jobs()) return;
    const bool waits = owner_missing_since_ && now - *owner_missing_since_ <= owner_timeout_;
    if (!waits || !services_.sessions.queue().empty()) close(now);
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

void SceneSession::node_built(const NodeRecord& node, const wire::VersionReport& report, TimePoint now) {
    if (!open_) return;
    built_transactions_ = published_transactions_;  // the report is about the published version
    traces_.node_built(node.id, node.hello.name, report.version, report.received_at, report.built_at,
                       node.clock.offset(now));
}

void SceneSession::node_refused(NodeRecord& node, const wire::SceneRefused& refusal, TimePoint now) {
    distributor_.refused(node, refusal);
    if (node.refused != authority_.version()) return;
    if (!open_ || is_exclusive()) return;
    bool any = false;
    for (const auto& [id, other] : services_.nodes.all()) {
        if (other.leaving) continue;
        if (other.refused != authority_.version()) return;  // it may still build it
        any = true;
    }
    if (any) withdraw_unbuildable("node " + node.hello.name + ": " + refusal.reason, now);
}

void SceneSession::withdraw_unbuildable(const std::string& reason, TimePoint now) {
    // Later edits have not been tried; one of them may be the remedy.
    const auto withdrawn =
        authority_.withdraw(built_transactions_, published_transactions_, {.name = "the master"});
    if (withdrawn.empty()) return;
    for (const SceneAuthority::Withdrawn& edit : withdrawn) {
        const std::string text = "edit " + std::to_string(edit.transaction) + " (" + edit.text +
                                 ") is undone, since no node can build the scene with it: " + reason;
        services_.events({wire::Severity::Error, text});
        if (const SessionRecord* author = services_.sessions.find(edit.author))
            services_.outbox.control(author->control, wire::Notice{wire::Severity::Error, text});
    }
    publish_if_due(now);
}

net::Bytes SceneSession::trace(const wire::ReadTrace& request) const {
    wire::Trace trace{request.request, traces_.latest(request.count)};
    net::Bytes message = wire::encode(wire::ControlMessage(trace));
    while (!wire::fits_control(message)) {  // drop the oldest
        trace.edits.erase(trace.edits.begin(),
                          trace.edits.begin() + static_cast<std::ptrdiff_t>((trace.edits.size() + 1) / 2));
        message = wire::encode(wire::ControlMessage(trace));
    }
    return message;
}

void SceneSession::done(const SessionRecord& session, std::uint64_t request, std::string problem) {
    const bool accepted = problem.empty();
    services_.outbox.control(session.control, wire::RequestDone{request, accepted, std::move(problem)});
}

void SceneSession::handle(SessionRecord& session, const wire::ReadScene& request) {
    if (std::string problem = reads_.read(session, request); !problem.empty())
        done(session, request.request, std::move(problem));
}

bool SceneSession::may_fetch(const SessionRecord& session, const Hash256& blob) const {
    return session.role != net::Role::Viewer || reads_.may_fetch(session.id, blob) || display_.has(blob);
}

void SceneSession::handle(SessionRecord& session, const wire::LockObjects& request) {
    if (request.release) {
        authority_.unlock(session.id, request.objects);
        return done(session, request.request, {});
    }
    std::string problems;
    for (const std::string& problem : authority_.lock(session.id, name(session.id), request.objects)) {
        problems += (problems.empty() ? "" : "; ") + problem;
    }
    done(session, request.request, problems);
}

void SceneSession::handle(SessionRecord& session, const wire::ReadHistory& request) {
    constexpr std::uint32_t MaxListed = 256;
    wire::History history{request.request, authority_.history(std::min(request.count, MaxListed))};
    net::Bytes message = wire::encode(wire::ControlMessage(history));
    while (!wire::fits_control(message)) {
        history.transactions.resize(history.transactions.size() / 2);
        message = wire::encode(wire::ControlMessage(history));
    }
    services_.outbox.control(session.control, std::move(message));
}

void SceneSession::handle(SessionRecord& session, const wire::ReadWriters& request) {
    services_.outbox.control(session.control,
                             wire::Writers{request.request, authority_.writers(request.object)});
}

void SceneSession::handle(SessionRecord& session, wire::RequestView request, TimePoint now) {
    std::string problem = request.share ? views_.share(session.id, request.number, request.wanted)
                                        : open_view(session, request.number, request.wanted, now);
    if (request.request != 0 || !problem.empty()) done(session, request.request, std::move(problem));
}

std::string SceneSession::open_view(const SessionRecord& session, std::uint64_t number,
                                    const session::ViewRequest& wanted, TimePoint now) {
    if (wanted.detached) {
        if (std::string problem = submission_problem(session, wanted); !problem.empty()) return problem;
    }
    if (std::string problem = problem_of(wanted); !problem.empty()) return problem;
    if (std::string problem = viewer_problem(session, number, wanted); !problem.empty()) return problem;
    view::View completed = wanted.view;
    complete(completed);
    if (std::string problem = memory_problem(film_bytes(completed), "the film of this view",
                                             views_.watched(session.id, number));
        !problem.empty())
        return problem;
    // Earlier edits are visible in the view, and the render origin follows the camera while it is the only one.
    publish_if_due(now);
    const bool waits_for_end = wanted.frames == session::Frames::Last;
    if (waits_for_end && authority_.has_unpublished() && views_.may_publish()) {
        if (auto changes = authority_.publish()) publish(std::move(*changes), now);
    }
    if (views_.table().all().size() <= 1) {
        const glm::dvec3 eye(wanted.view.camera.world_from_camera[3]);
        if (auto moved = authority_.follow_camera(eye)) publish(std::move(*moved), now);
    }
    const ViewOwner owner{session.id, name(session.id), session.user, members_.at(session.id).key};
    std::string problem = views_.open(owner, number, wanted, authority_.version(), now);
    if (problem.empty() && wanted.detached) record_job(wanted.name);
    return problem;
}

void SceneSession::handle(SessionRecord& session, const wire::SetViewFilter& request, TimePoint now) {
    wire::RequestDone done{.request = request.request, .accepted = true, .text = {}};
    try {
        done.text = views_.set_filter(session, request.view, request.filter, now);
    } catch (const Error& error) {
        done = {.request = request.request, .accepted = false, .text = error.what()};
    }
    services_.outbox.control(session.control, std::move(done));
}

std::string SceneSession::open_display(const scene::BlobPtr& description, std::vector<scene::BlobPtr> content,
                                       TimePoint now) {
    if (!open_) return "there is no live scene: join one first";
    std::string problem = display_.open(description, std::move(content), now);
    if (problem.empty()) follow_display(now);
    return problem;
}

void SceneSession::handle(SessionRecord& session, const wire::CloseDisplay& request) {
    const std::string problem = display_.is_open() ? "" : "no display is open";
    display_.close();
    done(session, request.request, problem);
}

void SceneSession::handle(SessionRecord& session, const wire::AdjustDisplay& request) {
    done(session, request.request, display_.adjust(request.adjustment));
}

void SceneSession::handle(SessionRecord& session, const wire::JoinOutput& request, TimePoint now) {
    if (std::string problem = display_.join(session, request, now); !problem.empty())
        done(session, request.request, std::move(problem));
}

// The render origin follows the display while there are no other views.
void SceneSession::follow_display(TimePoint now) {
    const auto& views = views_.table().all();
    if (!std::all_of(views.begin(), views.end(), [](const auto& entry) { return entry.second.in_group(); }))
        return;
    const auto head = display_.head_in_world();
    if (!head) return;
    if (auto moved = authority_.follow_camera(*head)) publish(std::move(*moved), now);
}

void SceneSession::publish(scene::ChangeList&& published, TimePoint now) {
    const auto shared = std::make_shared<const scene::ChangeList>(std::move(published));
    const scene::ChangeList& changes = *shared;
    published_at_ = now;
    ++counts_.versions;
    published_transactions_ = authority_.transactions();
    // Outdated work is cancelled before the change is sent to the nodes, so that they build sooner.
    const bool restarts = views_.scene_changed(changes, authority_.scene());
    const std::uint64_t before = services_.outbox.bytes.control;
    distributor_.published(services_.nodes, shared, now);
    counts_.change_bytes += services_.outbox.bytes.control - before;
    traces_.published(changes.to, now);
    if (display_.scene_changed(changes)) follow_display(now);
    if (views_.table().all().empty()) {
        traces_.no_open_views();
    } else if (!restarts) {
        traces_.merged(changes.to, now);  // the existing pictures show it
    }
}

void SceneSession::publish_if_due(TimePoint now) {
    const bool waits = authority_.has_unpublished();
    views_.pause_passes(waits);
    if (!waits || now - published_at_ < VersionInterval || !views_.may_publish()) return;
    if (auto changes = authority_.publish()) publish(std::move(*changes), now);
    views_.pause_passes(false);
}

void SceneSession::take(RenderOutput& output, TimePoint now) {
    if (const auto* report = std::get_if<MergeReport>(&output)) {
        const Dispatcher::Taken taken = services_.render.dispatcher.take(*report, now);
        if (taken != Dispatcher::Taken::Dropped) views_.took(*report, taken, now);
    } else if (const auto* failure = std::get_if<TaskFailure>(&output)) {
        services_.events({wire::Severity::Error, failure->text});
    } else if (const auto* encoded = std::get_if<EncodedScene>(&output)) {
        distributor_.take(*encoded, services_.nodes, now);
        reads_.take(*encoded);
    } else if (auto* made = std::get_if<OutputResult>(&output)) {
        display_.add_output(std::move(*made), now);
    } else {
        views_.take(output, now);
    }
}

// The order of a tick: published versions, passes with new samples, consumers of pictures, then work units for
// nodes and frames for clients.
void SceneSession::tick(TimePoint now) {
    keep_journal(now);
    collector_.tick(authority_, now);
    close_when_left(now);
    if (open_) {
        publish_if_due(now);
        reads_.tick();
    }
    views_.advance(now);
    display_.tick(now);
    views_.deal(now);
    store_finished_jobs(now);
    for (const FirstPicture& first : views_.take_first_pictures()) traces_.merged(first.version, first.at);
}

TimePoint SceneSession::next_event(TimePoint now) const {
    TimePoint next = std::min(views_.next_event(now), display_.next_event());
    if (open_ && authority_.has_unpublished())
        next = std::min(next, std::max(now, published_at_ + VersionInterval));
    return next;
}

session::SceneStatus SceneSession::status() const {
    if (!open_) return {};
    session::SceneStatus status = counts_;
    status.title = title();
    status.exclusive = is_exclusive();
    status.members = static_cast<std::uint32_t>(members_.size());
    status.views = static_cast<std::uint32_t>(views_.table().all().size());
    status.transactions = authority_.transactions();
    if (journal_) {
        status.journal_bytes = journal_->byte_size();
        status.checkpoints = journal_->checkpoints();
    }
    status.stages = traces_.stages();
    status.stages.push_back(views_.dispatcher().cancellations().summary("cancel to stopped"));
    return status;
}

}  // namespace tessera::master
