#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

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
    std::size_t max_sessions = 256, max_nodes = 1024;
};

// The event loop: one thread that owns the channel, keeps heartbeats and hands messages to the parts. It
// never renders and never merges (FilmStore does, on a thread of its own).
class RenderMaster {
  public:
    // Throws Error when the session folder cannot be used.
    RenderMaster(std::unique_ptr<net::Channel> channel, std::shared_ptr<scene::BlobStore> blobs,
                 const Clock& clock, const MasterSettings& settings, EventSink events);

    // Until the stop: then tells everybody goodbye.
    void run(std::stop_token stop);

    // Thread-safe: `task` runs in the loop soon (for example to re-read keys after SIGHUP).
    void post(std::function<void(net::Channel&)> task);

  private:
    void step(TimePoint now, std::stop_token stop);
    void receive(net::Message&& message, TimePoint now);
    void control(net::Message& message, TimePoint now);
    void bulk(net::Message& message, TimePoint now);

    void hello(const net::Message& message, wire::Hello hello, TimePoint now);
    void welcome(net::PeerId control, std::uint64_t number, std::uint64_t token);
    void from_node(NodeRecord& node, wire::ControlMessage& message, TimePoint now);
    void from_client(SessionRecord& session, wire::ControlMessage& message, std::size_t byte_size,
                     TimePoint now);
    void from_member(SessionRecord& session, wire::ControlMessage& message, TimePoint now);
    void bulk_hello(const net::Message& message, const wire::BulkHello& hello);
    void remove_node(NodeId id, const std::string& why);
    void remove_session(SessionId id, Views::Departure departure, TimePoint now);
    void heartbeats(TimePoint now);
    void bury_the_dead(TimePoint now);
    void drop_lost_peers(TimePoint now);
    void drop(const net::Message& message, const std::string& why);
    session::ClusterStatus status(TimePoint now) const;
    TimePoint next_wake(TimePoint now) const;
    void say_goodbye();

    std::unique_ptr<net::Channel> channel_;
    std::shared_ptr<scene::BlobStore> blobs_;
    const Clock& clock_;
    MasterSettings settings_;
    EventSink events_;
    TimePoint started_;

    Outbox outbox_;
    NodeTable nodes_;
    SessionTable sessions_;
    RenderOutputs outputs_;
    FilmStore film_;
    KeptJobs jobs_;
    Dispatcher dispatcher_;
    ViewIds view_ids_;
    SceneSession scene_;
    SessionService service_;
    std::uint64_t next_number_ = 1;
    std::uint64_t dropped_messages_ = 0;

    std::mutex mutex_;  // protects what stands below
    std::vector<std::function<void(net::Channel&)>> posted_;
};

}  // namespace tessera::master
