#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "client/channel_session.h"
#include "client/render.h"
#include "master/render_master.h"
#include "mediator/net/fault_plan.h"
#include "mediator/net/loopback.h"
#include "mediator/net/zmq_channel.h"
#include "node/render_node.h"
#include "tests/cluster/link_switch.h"

namespace tessera::test {

// How the peers of a test reach its master: in memory, or over sockets of ZeroMQ.
enum class Transport : std::uint8_t { Loopback, ZeroMQ };

// A master, nodes and clients in threads of this process, over the loopback or sockets, each with its own blob store.
// The picture must not change, whatever faults the fault plans inject into a node's channel.
class LoopbackCluster {
  public:
    struct NodeFaults {
        net::FaultPlan control, bulk;
    };

    // `adjust` changes the settings of the master, which are for quick tests.
    explicit LoopbackCluster(const std::function<void(master::MasterSettings&)>& adjust = {},
                             Transport transport = Transport::Loopback);
    ~LoopbackCluster();

    // `cost`: simulated time per sample of the null back-end.
    void add_node(const std::string& backend, const NodeFaults& faults = {}, Duration cost = {});
    using MakeBackend =
        std::function<std::unique_ptr<backend::Backend>(const backend::BackendSettings& settings)>;
    void add_node(const MakeBackend& make);
    // Of the null back-end; its link can be stalled and cut, and it reconnects. `link` must outlive it.
    void add_node(LinkSwitch& link, Duration cost);
    void remove_newest_node();  // it leaves at once
    std::unique_ptr<client::Session> session(std::shared_ptr<scene::BlobStore> blobs,
                                             net::Role role = net::Role::Editor,
                                             const std::string& user = "editor");
    // With an exclusive scene of scene_entries().
    std::unique_ptr<client::Session> batch(const std::shared_ptr<scene::BlobStore>& blobs);
    // A member of the shared scene "test", which it joins.
    std::unique_ptr<client::Session> member(const std::string& name, std::shared_ptr<scene::BlobStore> blobs,
                                            net::Role role = net::Role::Editor, const std::string& user = {});
    // A client controlled by the test.
    // With ZeroMQ everyone is an operator, since there are no keys.
    std::unique_ptr<net::Channel> channel(net::Role role, const std::string& user = {});
    // The master's loop is away for so long, from now on.
    void stall(Duration time) {
        master_->post([time](net::Channel&) { std::this_thread::sleep_for(time); });
    }
    std::vector<std::string> events() const;

  private:
    void start_node(const std::string& kind, std::unique_ptr<backend::Backend> made,
                    const std::shared_ptr<scene::BlobStore>& blobs, std::unique_ptr<net::Channel> channel,
                    std::function<void()> reconnect = {});

    SteadyClock clock_;
    net::LoopbackHub hub_;
    std::shared_ptr<net::ZmqContext> sockets_;  // null: the loopback
    std::string endpoint_;                      // of the sockets
    mutable std::mutex mutex_;                  // protects events_
    std::vector<std::string> events_;
    std::unique_ptr<master::RenderMaster> master_;
    std::jthread master_thread_;
    std::vector<std::unique_ptr<node::RenderNode>> nodes_;
    std::vector<std::jthread> node_threads_;
    std::size_t started_nodes_ = 0;
};

}  // namespace tessera::test
