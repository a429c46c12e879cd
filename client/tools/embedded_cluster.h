#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "master/render_master.h"
#include "mediator/net/zmq_channel.h"
#include "node/render_node.h"

namespace tessera::tools {

struct EmbeddedSettings {
    std::string backend;
    std::uint32_t nodes = 1;
    std::uint32_t threads = 0;  // total of all nodes; 0 = all cores
    std::string isa, device;    // of the back-end; "" = best
    std::string cache;          // cache folder for acceleration structures and kernels; "" = none
};

// A master and its nodes inside this process, connected over inproc and sharing one blob store, so that each blob
// exists once. The destructor stops them in order.
class EmbeddedCluster {
  public:
    // `events` is called on the threads of master and nodes. Throws Error when the back-end cannot start.
    EmbeddedCluster(const EmbeddedSettings& settings, std::shared_ptr<scene::BlobStore> blobs,
                    const Clock& clock, master::EventSink events);
    ~EmbeddedCluster();

    std::unique_ptr<net::Channel> client();  // a client's end

  private:
    void add_node(const EmbeddedSettings& settings, std::uint32_t index,
                  const std::shared_ptr<scene::BlobStore>& blobs, const Clock& clock);
    template <class Function>
    std::jthread guarded(Function function);

    std::shared_ptr<net::ZmqContext> context_;
    std::atomic<bool> is_stopping_ = false;  // suppresses events about disconnects during shutdown
    master::EventSink events_;
    std::unique_ptr<master::RenderMaster> master_;
    std::vector<std::unique_ptr<node::RenderNode>> nodes_;
    std::jthread master_thread_;
    std::vector<std::jthread> node_threads_;  // end before the master thread
};

}  // namespace tessera::tools
