#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

#include "master/guard.h"
#include "master/loop/intake.h"
#include "master/loop/loop_monitor.h"
#include "master/peers/event_limiter.h"
#include "master/peers/node_table.h"
#include "master/peers/outbox.h"
#include "master/peers/session_table.h"
#include "master/scene_session.h"
#include "master/session_service.h"
#include "mediator/base/clock.h"
#include "mediator/net/channel.h"

namespace tessera::master {

struct MasterSettings {
    std::uint64_t epoch = 0;  // 0 = chosen at random
    std::string software = "tessera";
    net::LivenessSettings liveness;
    StuckSettings stuck;
    ViewSettings views;
    std::filesystem::path session_folder;  // on disk; empty = in memory alone
    Duration checkpoint_interval = std::chrono::seconds(10);
    wire::BlobLimits blob_limits;
    std::uint64_t memory_limit =
        0;  // bytes of films, blobs and outboxes; 0: three quarters of the machine's memory
    Duration collect_interval = std::chrono::seconds(10);  // of unused blobs; zero: never, for a shared store
    double verified_share = 0.0;  // of the film of nodes, 0 to 1: see render/verifier.h
    std::size_t max_sessions = 256, max_nodes = 1024;
    std::size_t max_sessions_per_key = 64;
    std::size_t sessions_for_operators = 8;  // of max_sessions: others cannot lock them out
    std::function<net::RefusedTraffic()> refused_traffic =
        {};  // by the channel, for the status; none: unknown
};

// The event loop: one thread that owns the channel, sends heartbeats and dispatches messages. It never renders
// and never merges film (FilmStore does that on another thread).
class RenderMaster {
  public:
    // Throws Error if the session folder cannot be used.
    RenderMaster(std::unique_ptr<net::Channel> channel, std::shared_ptr<scene::BlobStore> blobs,
                 const Clock& clock, const MasterSettings& settings, EventSink events);

    // Runs until stopped, then sends Goodbye to all peers.
    void run(std::stop_token stop);

    // Thread-safe: `task` runs in the loop soon (for example to re-read keys after SIGHUP).
    void post(std::function<void(net::Channel&)> task);

  private:
    void step(TimePoint now, std::stop_token stop);
    bool take_in(net::Received received);  // false: more messages may have arrived
    void serve_messages(TimePoint begun, const std::stop_token& stop);
    void forgive_silence(Duration time, TimePoint now);
    std::string full_text(bool is_node,
                          const net::Message& message) const;  // why no more can join; "" = they can
    void run_posted();
    void receive(net::Message&& message, TimePoint now);
    void control(net::Message& message, TimePoint now);
    void bulk(net::Message& message, TimePoint now);
    bool must_wait(const SessionRecord& session, const wire::ControlMessage& message) const;
    void hold(SessionRecord& session, const net::Message& message, wire::ControlMessage&& decoded);
    void serve_held_messages(TimePoint now);

    void hello(const net::Message& message, wire::Hello hello, TimePoint now);
    void welcome(net::PeerId control, std::uint64_t number, std::uint64_t token);
    void from_node(NodeRecord& node, wire::ControlMessage& message, TimePoint now);
    void from_client(SessionRecord& session, wire::ControlMessage& message, std::size_t byte_size,
                     TimePoint now);
    void from_member(SessionRecord& session, wire::ControlMessage& message, TimePoint now);
    void bulk_hello(const net::Message& message, const wire::BulkHello& hello);
    void remove_node(NodeId id, const std::string& why, Dispatcher::Departure departure, TimePoint now);
    void manage_node(const SessionRecord& session, const wire::ManageNode& order, TimePoint now);
    void remove_session(SessionId id, Views::DisconnectReason reason, TimePoint now);
    void heartbeats(TimePoint now);
    void remove_timed_out_peers(TimePoint now);
    void drop_lost_peers(TimePoint now);
    void drop(const net::Message& message, const std::string& why);
    session::ClusterStatus status(TimePoint now) const;
    net::Bytes status_page(NodeId after, TimePoint now) const;
    TimePoint next_wake(TimePoint now) const;
    void save_at_the_end();
    void send_goodbye();

    std::unique_ptr<net::Channel> channel_;
    std::shared_ptr<scene::BlobStore> blobs_;
    const Clock& clock_;
    MasterSettings settings_;
    EventLimiter limiter_;
    EventSink events_;
    TimePoint started_;
    TimePoint now_before_{};  // the end of the last step
    // Peers whose connections were broken at the end of the step before. What they sent last, film and a goodbye, has
    // been read by now.
    std::vector<std::pair<net::Link, net::PeerId>> lost_;
    TimePoint broken_until_{};  // after a stall: peers whose connections are broken may be coming back

    LoopMonitor monitor_;
    Guard guard_;
    Intake intake_;
    Outbox outbox_;
    NodeTable nodes_;
    SessionTable sessions_;
    RenderOutputs outputs_;
    FilmStore film_;
    JobStore jobs_;
    Dispatcher dispatcher_;
    ViewIds view_ids_;
    SceneSession scene_;
    SessionService service_;
    std::uint64_t next_number_ = 1;
    std::uint64_t dropped_messages_ = 0, lost_nodes_ = 0, lost_sessions_ = 0;
    std::string_view message_kind_;  // of the message that is being served

    std::mutex mutex_;  // protects the members below
    std::vector<std::function<void(net::Channel&)>> posted_;
};

}  // namespace tessera::master
