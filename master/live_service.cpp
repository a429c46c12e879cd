#include "master/live_service.h"

#include <algorithm>

#include "mediator/wire/envelope.h"

namespace tessera::master {

namespace {

constexpr Duration VersionInterval = std::chrono::milliseconds(16);
constexpr std::size_t MaxNameLength = 64, MaxPresenceText = 1024, MaxSelection = 1024;
constexpr Duration MaxPresence = std::chrono::minutes(10);

}  // namespace

LiveService::LiveService(SceneAuthority& authority, std::shared_ptr<scene::BlobStore> blobs,
                         SessionTable& sessions, LiveRunner& runner, DisplayService& display, Outbox& outbox,
                         EventSink events, std::function<void(const scene::ChangeList&, TimePoint)> publish)
    : authority_(authority),
      blobs_(std::move(blobs)),
      sessions_(sessions),
      runner_(runner),
      display_(display),
      outbox_(outbox),
      events_(std::move(events)),
      publish_(std::move(publish)) {
    runner_.on_first_picture = [this](Version version, TimePoint now) { traces_.merged(version, now); };
}

std::string LiveService::unique_name(const std::string& wanted) const {
    const auto taken = [&](const std::string& name) {
        return std::any_of(members_.begin(), members_.end(),
                           [&](const auto& entry) { return entry.second.name == name; });
    };
    const std::string base = wanted.empty() ? "client" : wanted.substr(0, MaxNameLength);
    if (!taken(base)) return base;
    for (int number = 2;; ++number) {
        const std::string name = base + " (" + std::to_string(number) + ")";
        if (!taken(name)) return name;
    }
}

void LiveService::open(const std::string& title) {
    if (journal_ != nullptr) journal_->opened(title);
    open_ = true;
    title_ = title;
    counts_ = {};
    traces_ = {};
    events_({wire::Severity::Info, "live scene '" + title_ + "' is open"});
}

void LiveService::record_to(LiveJournal& journal, TimePoint now) {
    journal_ = &journal;
    const Recovery& recovery = journal.recovery();
    if (!recovery.found || recovery.title.empty()) {
        (void)authority_.clear();
        return;
    }
    open(recovery.title);
    std::vector<wire::SavedView> views = recovery.views;
    runner_.restore(std::move(views), authority_.version(), authority_.state_hash(), now);
}

void LiveService::join(SessionRecord& session, const wire::JoinScene& request, TimePoint now) {
    const bool may_edit = session.role != net::Role::Viewer;
    if (may_edit && request.key == 0)
        throw Error(ErrorCode::Refused, "a member needs a key that it has chosen, not 0");
    if (!open_) open(request.title.empty() ? "untitled" : request.title);
    // Who only looks needs neither ids nor a place in the journal.
    const IdRange ids = may_edit ? authority_.join(session.id, session.user, request.key) : IdRange{};
    if (may_edit && ids.count == 0) {
        throw Error(ErrorCode::Refused,
                    "no ids are left to lend, or the session folder cannot be written: see the master's log");
    }
    if (!members_.contains(session.id)) {
        Member& member = members_[session.id];
        member.name = unique_name(request.name);
        member.key = request.key;
        events_({wire::Severity::Info, member.name + " (" + session.user + ") joined '" + title_ + "'"});
    }
    publish_if_due(now);
    outbox_.control(session.control, wire::SceneJoined{.version = authority_.version(),
                                                       .first_id = ids.first,
                                                       .id_count = ids.count,
                                                       .last_sequence = authority_.last_sequence(session.id),
                                                       .title = title_,
                                                       .name = members_.at(session.id).name});
}

void LiveService::close(TimePoint now) {
    if (!open_) return;
    open_ = false;
    events_({wire::Severity::Info, "live scene '" + title_ + "' is closed"});
    display_.close();
    runner_.close_all();
    for (const auto& [id, member] : members_) authority_.forget(id);
    members_.clear();
    reads_.clear();
    if (auto cleared = authority_.clear()) publish(*cleared, now);
    if (journal_ != nullptr) journal_->closed();
}

void LiveService::left(SessionId session, LiveRunner::Departure departure, TimePoint now) {
    const auto member = members_.find(session);
    if (member == members_.end()) return;
    events_({wire::Severity::Info, member->second.name + " left '" + title_ + "'"});
    runner_.session_left(session, departure, now);
    display_.left(session, now);
    authority_.release_all(session);
    authority_.forget(session);
    members_.erase(member);
    std::erase_if(reads_, [&](const WaitingRead& read) { return read.session == session; });
}

void LiveService::edited(const SessionRecord& session, const scene::Edit& edit, const EditAnswer& answer,
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

void LiveService::node_built(const NodeRecord& node, const wire::VersionReport& report, TimePoint now) {
    if (!open_) return;
    traces_.node_built(node.id, node.hello.name, report.version, report.received_at, report.built_at,
                       node.clock.offset(now));
}

wire::Trace LiveService::trace(const wire::ReadTrace& request) const {
    wire::Trace trace{request.request, traces_.latest(request.count)};
    while (!wire::fits_control(trace))  // the older ones go
        trace.edits.erase(trace.edits.begin(),
                          trace.edits.begin() + static_cast<std::ptrdiff_t>((trace.edits.size() + 1) / 2));
    return trace;
}

void LiveService::done(const SessionRecord& session, std::uint64_t request, std::string problem) {
    const bool accepted = problem.empty();
    outbox_.control(session.control, wire::RequestDone{request, accepted, std::move(problem)});
}

void LiveService::asked(SessionRecord& session, const wire::ReadScene& request) {
    reads_.push_back({session.id, request, authority_.pending()});
}

// At most one content a member is kept; a second question before the first content was fetched gets a newer
// one.
void LiveService::answer(const WaitingRead& read) {
    const SessionRecord* session = sessions_.find(read.session);
    if (session == nullptr) return;
    auto changes = authority_.since(read.request.known);
    wire::SceneContent content{.request = read.request.request,
                               .list = changes ? std::move(*changes) : authority_.snapshot(),
                               .blob = {}};
    if (!wire::fits_control(content)) {
        const scene::BlobPtr blob = blobs_->insert(wire::encode(content.list));
        members_.at(read.session).content = blob;
        content.list = {};
        content.blob = scene::reference(*blob);
    }
    outbox_.control(session->control, std::move(content));
}

void LiveService::asked(SessionRecord& session, const wire::LockObjects& request) {
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

void LiveService::asked(SessionRecord& session, wire::SetPresence request, TimePoint now) {
    Member& member = members_.at(session.id);
    request.text.resize(std::min(request.text.size(), MaxPresenceText));
    request.selection.resize(std::min(request.selection.size(), MaxSelection));
    member.presence_until = now + std::clamp(request.time_to_live, Duration::zero(), MaxPresence);
    member.presence = std::move(request);
}

void LiveService::asked(SessionRecord& session, const wire::ReadPeople& request, TimePoint now) {
    wire::People people{.request = request.request, .title = title_, .locks = authority_.locks()};
    for (const auto& [id, member] : members_) {
        const SessionRecord* other = sessions_.find(id);
        if (other == nullptr) continue;
        wire::Person person{.session = id,
                            .name = member.name,
                            .user = other->user,
                            .editor = other->role != net::Role::Viewer};
        if (const auto clock = other->clock.offset(now)) {
            person.clock_offset_seconds = seconds(clock->offset);
            person.clock_bound_seconds = seconds(clock->bound);
        }
        if (now < member.presence_until) {
            person.text = member.presence.text;
            person.selection = member.presence.selection;
        }
        people.people.push_back(std::move(person));
    }
    for (const auto& [id, live] : runner_.views()) {
        people.views.push_back(
            {.name = live.name,
             .owner = live.owner_name,
             .width = live.view.width,
             .height = live.view.height,
             .samples = live.shown ? live.shown->samples / live.view.window.pixel_count() : 0,
             .spp = live.spp,
             .watchers = runner_.watchers(id)});
    }
    outbox_.control(session.control, std::move(people));
}

void LiveService::asked(SessionRecord& session, const wire::ReadHistory& request) {
    constexpr std::uint32_t MaxTold = 256;
    wire::History history{request.request, authority_.history(std::min(request.count, MaxTold))};
    while (!wire::fits_control(history)) history.transactions.resize(history.transactions.size() / 2);
    outbox_.control(session.control, std::move(history));
}

void LiveService::asked(SessionRecord& session, const wire::ReadWriters& request) {
    outbox_.control(session.control, wire::Writers{request.request, authority_.writers(request.object)});
}

void LiveService::asked(SessionRecord& session, wire::OpenLiveView request, TimePoint now) {
    const std::uint64_t number = request.request;
    const glm::dvec3 eye(request.view.camera.world_from_camera[3]);
    const bool leads = !request.share && runner_.views().size() <= 1;
    std::string problem =
        runner_.open({session.id, name(session.id), session.user, members_.at(session.id).key},
                     std::move(request), authority_.version(), now);
    // The render origin follows the camera while it is the only one.
    if (problem.empty() && leads) {
        if (auto moved = authority_.follow_camera(eye)) publish(*moved, now);
    }
    if (number != 0 || !problem.empty()) done(session, number, std::move(problem));
}

std::string LiveService::open_display(const scene::BlobPtr& description, std::vector<scene::BlobPtr> content,
                                      TimePoint now) {
    if (!open_) return "there is no live scene: join one first";
    std::string problem = display_.open(description, std::move(content), now);
    if (problem.empty()) follow_display(now);
    return problem;
}

void LiveService::asked(SessionRecord& session, const wire::CloseDisplay& request) {
    const std::string problem = display_.is_open() ? "" : "no display is open";
    display_.close();
    done(session, request.request, problem);
}

void LiveService::asked(SessionRecord& session, const wire::AdjustDisplay& request) {
    done(session, request.request, display_.adjust(request));
}

void LiveService::asked(SessionRecord& session, const wire::JoinOutput& request, TimePoint now) {
    if (std::string problem = display_.join(session, request, now); !problem.empty())
        done(session, request.request, std::move(problem));
}

// The render origin follows the display while nobody else looks.
void LiveService::follow_display(TimePoint now) {
    const auto& views = runner_.views();
    if (!std::all_of(views.begin(), views.end(), [](const auto& entry) { return entry.second.in_group; }))
        return;
    const auto head = display_.head_in_world();
    if (!head) return;
    if (auto moved = authority_.follow_camera(*head)) publish(*moved, now);
}

void LiveService::publish(const scene::ChangeList& changes, TimePoint now) {
    published_at_ = now;
    ++counts_.versions;
    // What is out of date is cancelled before the nodes hear of the change: they build sooner.
    const bool restarts = runner_.scene_changed(changes, authority_.scene(), now);
    const std::uint64_t before = outbox_.bytes.control;
    publish_(changes, now);
    counts_.change_bytes += outbox_.bytes.control - before;
    traces_.published(changes.to, now);
    if (display_.scene_changed(changes)) follow_display(now);
    if (runner_.views().empty()) {
        traces_.nobody_looks();
    } else if (!restarts) {
        traces_.merged(changes.to, now);  // the pictures that there are show it
    }
}

void LiveService::publish_if_due(TimePoint now) {
    const bool waits = authority_.has_unpublished();
    runner_.hold_passes(waits);
    if (!waits || now - published_at_ < VersionInterval || !runner_.may_publish()) return;
    if (auto changes = authority_.publish()) publish(*changes, now);
    runner_.hold_passes(false);
}

void LiveService::tick(TimePoint now) {
    if (journal_ != nullptr) journal_->tick(title_, now);
    if (!open_) return;
    publish_if_due(now);
    std::erase_if(reads_, [&](const WaitingRead& read) {
        if (authority_.version().number < read.wanted.number) return false;
        answer(read);
        return true;
    });
}

TimePoint LiveService::next_event(TimePoint now) const {
    if (!open_ || !authority_.has_unpublished()) return TimePoint::max();
    return std::max(now, published_at_ + VersionInterval);
}

wire::LiveStatus LiveService::status() const {
    if (!open_) return {};
    wire::LiveStatus status = counts_;
    status.title = title_;
    status.members = static_cast<std::uint32_t>(members_.size());
    status.views = static_cast<std::uint32_t>(runner_.views().size());
    status.transactions = authority_.transactions();
    if (journal_ != nullptr) {
        status.journal_bytes = journal_->byte_size();
        status.checkpoints = journal_->checkpoints();
    }
    status.stages = traces_.stages();
    status.stages.push_back(runner_.cancellations().summary("cancel to stopped"));
    return status;
}

}  // namespace tessera::master
