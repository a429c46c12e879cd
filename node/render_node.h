#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "mediator/backend/backend.h"
#include "mediator/base/clock.h"
#include "mediator/net/channel.h"
#include "node/node_state_machine.h"
#include "node/settings.h"

namespace tessera::node {

struct NodeCallbacks {
    std::function<void(const Report&)> event;  // for the log; called on the thread of run()
    std::function<void()> reconnect;  // new sockets behind the same channel; may be empty (in-process)
};

struct NodeResult {
    std::string failure;  // why it had to leave; "" if it was asked to
    NodeCounters counters;
};

// A node of the cluster, in its own process or embedded: the event loop of the state machine, its workers and the
// scene builder. The thread of run() owns the channel and neither renders nor builds, so heartbeats continue.
class RenderNode {
  public:
    // `blobs` is the back-end's store. Throws Error if the disk cache cannot be used.
    RenderNode(std::unique_ptr<net::Channel> channel, std::unique_ptr<backend::Backend> backend,
               std::shared_ptr<scene::BlobStore> blobs, const Clock& clock, const NodeSettings& settings,
               NodeCallbacks callbacks);
    ~RenderNode();

    // Runs until the node has left. `drain`: finish the units being rendered, return the others, send Goodbye.
    // `at_once`: leave without finishing. Call once.
    NodeResult run(std::stop_token drain, std::stop_token at_once = {});

  private:
    struct FinishedUnit {
        UnitId unit;
        UnitOutcome outcome;
    };
    struct LookedUp {
        std::vector<scene::BlobRef> blobs;
    };
    using Event = std::variant<FinishedUnit, BuildOutcome, LookedUp>;
    class Loop;

    void post(Event&& event);  // any thread
    std::vector<Event> take_events();

    std::unique_ptr<net::Channel> channel_;
    std::unique_ptr<backend::Backend> backend_;
    std::shared_ptr<scene::BlobStore> blobs_;
    const Clock& clock_;
    NodeSettings settings_;
    NodeCallbacks callbacks_;
    std::shared_ptr<class BlobCache> cache_;  // null: none

    std::mutex mutex_;  // protects events_
    std::vector<Event> events_;
};

}  // namespace tessera::node
