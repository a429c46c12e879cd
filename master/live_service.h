#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "master/display/display_service.h"
#include "master/live_journal.h"
#include "master/peers/session_table.h"
#include "master/render/live_runner.h"
#include "master/scene/edit_trace.h"
#include "master/scene/scene_authority.h"

namespace tessera::master {

// The live scene: who is in it, what they ask, and when their edits become a version. Told of messages by the
// render master.
//
// Edits are taken and answered at once. A version is published at once when no first picture is on its way
// and the last version is 16 ms old, else as soon as both are so.
class LiveService {
  public:
    // `publish` hands a change list to all nodes.
    LiveService(SceneAuthority& authority, std::shared_ptr<scene::BlobStore> blobs, SessionTable& sessions,
                LiveRunner& runner, DisplayService& display, Outbox& outbox, EventSink events,
                std::function<void(const scene::ChangeList&, TimePoint)> publish);

    // From now on edits are recorded in it. What it recovered is open again. Must outlive its use.
    void record_to(LiveJournal& journal, TimePoint now);

    bool is_open() const { return open_; }
    bool is_member(SessionId session) const { return members_.contains(session); }
    const std::string& name(SessionId session) const { return members_.at(session).name; }
    std::size_t member_count() const { return members_.size(); }
    const std::string& title() const { return title_; }

    // The stage is the live scene's. Throws Error when the session cannot be let in.
    void join(SessionRecord& session, const wire::JoinScene& request, TimePoint now);
    // Everybody is out, the scene is empty, the stage is free again.
    void close(TimePoint now);
    void left(SessionId session, LiveRunner::Departure departure, TimePoint now);

    // A member's edit was answered.
    void edited(const SessionRecord& session, const scene::Edit& edit, const EditAnswer& answer,
                std::uint64_t message_bytes, TimePoint now);
    void node_built(const NodeRecord& node, const wire::VersionReport& report, TimePoint now);
    void node_gone(NodeId node) { traces_.node_gone(node); }

    void asked(SessionRecord& session, const wire::ReadScene& request);
    void asked(SessionRecord& session, const wire::LockObjects& request);
    void asked(SessionRecord& session, wire::SetPresence request, TimePoint now);
    void asked(SessionRecord& session, const wire::ReadPeople& request, TimePoint now);
    void asked(SessionRecord& session, const wire::ReadHistory& request);
    void asked(SessionRecord& session, const wire::ReadWriters& request);
    void asked(SessionRecord& session, wire::OpenLiveView request, TimePoint now);

    // "" or what is wrong.
    std::string open_display(const scene::BlobPtr& description, std::vector<scene::BlobPtr> content,
                             TimePoint now);
    void asked(SessionRecord& session, const wire::CloseDisplay& request);
    void asked(SessionRecord& session, const wire::AdjustDisplay& request);
    void asked(SessionRecord& session, const wire::JoinOutput& request, TimePoint now);

    wire::Trace trace(const wire::ReadTrace& request) const;

    void tick(TimePoint now);
    TimePoint next_event(TimePoint now) const;
    wire::LiveStatus status() const;

  private:
    struct Member {
        std::string name;
        std::uint64_t key = 0;
        wire::SetPresence presence;
        TimePoint presence_until{};
        scene::BlobPtr content;  // the scene as it was read last: kept until the client has it
    };
    struct WaitingRead {
        SessionId session;
        wire::ReadScene request;
        Version wanted;  // that has all edits made before the question
    };

    void open(const std::string& title);
    std::string unique_name(const std::string& wanted) const;
    void answer(const WaitingRead& read);
    void done(const SessionRecord& session, std::uint64_t request, std::string problem);
    void follow_display(TimePoint now);
    void publish_if_due(TimePoint now);
    void publish(const scene::ChangeList& changes, TimePoint now);

    SceneAuthority& authority_;
    std::shared_ptr<scene::BlobStore> blobs_;
    SessionTable& sessions_;
    LiveRunner& runner_;
    DisplayService& display_;
    LiveJournal* journal_ = nullptr;
    Outbox& outbox_;
    EventSink events_;
    std::function<void(const scene::ChangeList&, TimePoint)> publish_;
    bool open_ = false;
    std::string title_;
    std::map<SessionId, Member> members_;
    std::vector<WaitingRead> reads_;
    TimePoint published_at_{};
    wire::LiveStatus counts_;
    EditTraceLog traces_;
};

}  // namespace tessera::master
