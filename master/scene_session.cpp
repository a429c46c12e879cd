#include "master/scene_session.h"

#include <unistd.h>

#include <algorithm>

#include "mediator/wire/envelope.h"

namespace tessera::master {

namespace {

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
      published_(authority_.published()),
      encoder_([&outputs = services.render.outputs](EncodedScene made) { outputs.put(std::move(made)); }),
      distributor_(published_, encoder_, *services.blobs, services.outbox, services.events),
      reads_(published_, encoder_, *services.blobs, services.sessions, services.outbox),
      collector_(services.blobs, services.collect_interval),
      views_(settings, services.render, services.sessions, services.outbox, services.events,
             [this](ObjectId id) {
                 const scene::Object* object = published_.scene().find(id);
                 return object ? scene::name(*object) : std::string();
             }),
      display_(published_, services.sessions, views_, services.outbox, services.events),
      thread_([&outputs = services.render.outputs] { outputs.put(EditDone{}); }) {}

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

void SceneSession::opened(wire::RecordedTitle scene) {
    open_ = true;
    scene_ = std::move(scene);
    owner_missing_since_.reset();
    views_.charge_from(services_.outbox.bytes);
    counts_ = {};
    traces_ = {};
    published_transactions_ = built_transactions_ = transactions_ = authority_.transactions();
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
    struct Joining {
        std::optional<wire::RecordedTitle> opens;
        IdRange ids;
        std::string problem;
    };
    const auto joining = std::make_shared<Joining>();
    if (!open_) {
        joining->opens = {.title = request.title.empty() ? "untitled" : request.title,
                          .owner = request.exclusive
                                       ? std::optional(wire::RecordedOwner{session.user, request.key})
                                       : std::nullopt};
    }
    owner_missing_since_.reset();
    // Viewers need neither ids nor a journal record.
    const auto work = [this, joining, may_edit, id = session.id, user = session.user,
                       key = request.key](SceneAuthority& authority) {
        try {
            if (joining->opens && journal_) journal_->opened(*joining->opens);
            if (may_edit) joining->ids = authority.join(id, user, key);
        } catch (const std::exception& error) {
            joining->problem = error.what();
        }
    };
    const auto then = [this, joining, may_edit, id = session.id, request](TimePoint at) {
        if (joining->opens && joining->problem.empty()) opened(std::move(*joining->opens));
        const SessionRecord* joined_session = services_.sessions.find(id);
        if (joined_session == nullptr) return authority_.forget(id);
        if (may_edit && joining->problem.empty() && joining->ids.count == 0) {
            joining->problem =
                "all object ids are allocated, or the session folder cannot be written: see the master's log";
        }
        if (joining->problem.empty()) return joined(id, request, joining->ids, at);
        services_.outbox.control(joined_session->control, wire::Refusal{joining->problem});
    };
    requester_ = session.id;
    run({.writes = may_edit || joining->opens}, work, then, now);
}

void SceneSession::joined(SessionId id, const wire::JoinScene& request, const IdRange& ids, TimePoint now) {
    const SessionRecord& session = *services_.sessions.find(id);
    if (!members_.contains(id)) {
        Member& member = members_[id];
        member.name = unique_name(request.name);
        member.key = request.key;
        services_.events(
            {wire::Severity::Info, member.name + " (" + session.user + ") joined '" + title() + "'"});
    }
    const std::uint64_t last_sequence = authority_.last_sequence(id);
    publish_if_due(now);
    services_.outbox.control(session.control, wire::SceneJoined{.version = published_.version(),
                                                                .first_id = ids.first,
                                                                .id_count = ids.count,
                                                                .last_sequence = last_sequence,
                                                                .title = title(),
                                                                .name = members_.at(id).name});
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
    scene_ = {};
    const auto cleared = std::make_shared<std::optional<scene::ChangeList>>();
    run(
        {published_.scene().objects().size() + authority_.unpublished_objects(), true},
        [cleared](SceneAuthority& authority) { *cleared = authority.clear(); },
        [this, cleared](TimePoint at) {
            if (*cleared) publish(std::move(**cleared), at);
            collector_.scene_closed();
            if (journal_) journal_->closed();
        },
        now);
}

void SceneSession::left(SessionId session, Views::DisconnectReason reason, TimePoint now) {
    const auto member = members_.find(session);
    if (member == members_.end()) return;
    services_.events({wire::Severity::Info, member->second.name + " left '" + title() + "'"});
    views_.session_left(session, reason, now);
    display_.left(session, now);
    forget_editor(session);
    members_.erase(member);
    reads_.left(session);
    if (reason == Views::DisconnectReason::Timeout && members_.empty()) owner_missing_since_ = now;
    close_when_left(now);
}

// An exclusive scene is closed when its owner leaves, unless jobs continue. One that was recovered, or whose owner was
// lost, waits for its owner for a while, but not once it only keeps others waiting.
void SceneSession::close_when_left(TimePoint now) {
    if (!open_ || is_editing() || !is_exclusive() || !members_.empty() || views_.has_jobs()) return;
    const bool waits = owner_missing_since_ && now - *owner_missing_since_ <= owner_timeout_;
    if (!waits || !services_.sessions.queue().empty()) close(now);
}

void SceneSession::node_built(const NodeRecord& node, const wire::VersionReport& report, TimePoint now) {
    if (!open_) return;
    built_transactions_ = published_transactions_;  // the report is about the published version
    traces_.node_built(node.id, node.hello.name, report.version, report.received_at, report.built_at,
                       node.clock.offset(now));
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
    if (std::string problem = reads_.read(session, request, authority_.pending()); !problem.empty())
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

void SceneSession::handle(SessionRecord& session, const wire::SetViewFilter& request, TimePoint now) {
    wire::RequestDone done{.request = request.request, .accepted = true, .text = {}};
    try {
        const auto room_problem = [this](const session::ViewRequest& completed, ViewId replaced) {
            return memory_problem(completed, replaced);
        };
        done.text = views_.set_filter(session, request.view, request.filter, room_problem, now);
    } catch (const Error& error) {
        done = {.request = request.request,
                .accepted = false,
                .text = error.what(),
                .unavailable = error.code() == ErrorCode::Unavailable};
    }
    services_.outbox.control(session.control, std::move(done));
}

std::string SceneSession::open_display(const scene::BlobPtr& description, std::vector<scene::BlobPtr> content,
                                       TimePoint now) {
    if (!open_) return "there is no live scene: join one first";
    // Its camera may have come with the edit before.
    if (!is_editing() && authority_.has_unpublished() && views_.may_publish())
        publish_edits([](TimePoint) {}, now);
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

void SceneSession::take(RenderOutput& output, TimePoint now) {
    if (const auto* report = std::get_if<MergeReport>(&output)) {
        const Dispatcher::Taken taken = services_.render.dispatcher.take(*report, now);
        if (taken != Dispatcher::Taken::Dropped) views_.took(*report, taken, now);
    } else if (const auto* failure = std::get_if<TaskFailure>(&output)) {
        services_.events({wire::Severity::Error, failure->text});
    } else if (const auto* encoded = std::get_if<EncodedScene>(&output)) {
        distributor_.take(*encoded, services_.nodes, now);
        reads_.take(*encoded);
    } else if (std::holds_alternative<EditDone>(output)) {
        thread_.finish(now);
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
    if (!is_editing()) collector_.tick(authority_, now);
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
    if (open_ && !is_editing() && authority_.has_unpublished()) {
        const TimePoint interval_ends = published_at_ + VersionInterval;
        const bool waits_for_frame = unpublished_since_ && interval_ends <= now;  // which is an event, too
        next = std::min(
            next, std::max(now, waits_for_frame ? *unpublished_since_ + FirstFrameWait : interval_ends));
    }
    return next;
}

session::SceneStatus SceneSession::status() const {
    if (!open_) return {};
    session::SceneStatus status = counts_;
    status.title = title();
    status.exclusive = is_exclusive();
    status.members = static_cast<std::uint32_t>(members_.size());
    status.views = static_cast<std::uint32_t>(views_.table().all().size());
    status.transactions = transactions_;
    if (journal_) {
        status.journal_bytes = journal_bytes_;
        status.checkpoints = journal_->checkpoints();
    }
    status.stages = traces_.stages();
    status.stages.push_back(views_.dispatcher().cancellations().summary("cancel to stopped"));
    return status;
}

}  // namespace tessera::master
