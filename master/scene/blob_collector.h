#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "master/scene/scene_authority.h"
#include "mediator/base/clock.h"
#include "mediator/base/task_thread.h"

namespace tessera::master {

// Frees blobs that neither the scene nor an undo step refers to, while the scene lives; what is held elsewhere (by the
// display, by edits that wait for more) stays. Counts what the clients of each key have sent and the master still has.
// Reads a copy of the state on a thread of its own; all other calls are from the event loop.
class BlobCollector {
  public:
    // `interval`: at most so often, and only after edits; zero: never, for a store that others use as well.
    BlobCollector(std::shared_ptr<scene::BlobStore> blobs, Duration interval)
        : blobs_(std::move(blobs)), interval_(interval) {}

    void received(const std::string& user, const scene::BlobRef& blob);  // by a client of that key
    std::uint64_t held_bytes(const std::string& user) const;
    void scene_closed();  // the store has dropped what only the scene used
    void tick(const SceneAuthority& authority, TimePoint now);

  private:
    void collect(const AuthorityState& state, std::uint64_t mark);
    struct Sent {
        std::string user;
        std::uint64_t bytes = 0;
    };
    void forget(const scene::BlobRef& blob);
    void release(const Sent& sent);

    std::shared_ptr<scene::BlobStore> blobs_;
    Duration interval_;
    TimePoint last_{};
    std::uint64_t transactions_ = 0;  // at the last time
    Version version_;
    std::map<Hash256, Sent> senders_;
    std::map<std::string, std::uint64_t> held_;

    std::mutex mutex_;  // protects the members below
    bool is_running_ = false;
    std::vector<scene::BlobRef> freed_;
    std::unique_ptr<TaskThread> thread_;  // the last member, since its tasks use the others
};

}  // namespace tessera::master
