#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "master/render/live_runner.h"
#include "master/scene/checkpoint_writer.h"
#include "master/scene/journal.h"
#include "master/scene/recovery.h"

namespace tessera::master {

// A live scene on disk: what happens to it, as it happens, and every `interval` all of it with the films of
// its views. Lives in the render master's loop, which it never holds for longer than a copy of the scene's
// map: films are copied by the merger, files written by a thread of their own.
class LiveJournal {
  public:
    // Takes the folder, brings `authority` to what its last master left there, and records from now on.
    // Throws Error, naming the folder, when it is in use or of no use.
    LiveJournal(const std::filesystem::path& folder, Duration interval, SceneAuthority& authority,
                std::shared_ptr<scene::BlobStore> blobs, LiveRunner& runner, EventSink events);

    const Recovery& recovery() const { return recovery_; }
    // The scene is open: edits are recorded. Throws Error{Io} when they cannot be.
    void opened(const std::string& title);
    void closed();

    void tick(const std::string& title, TimePoint now);
    std::uint64_t byte_size() const { return journal_->byte_size(); }
    std::uint64_t checkpoints() const { return checkpoints_; }

  private:
    SessionFolder folder_;
    Duration interval_;
    SceneAuthority& authority_;
    LiveRunner& runner_;
    EventSink events_;
    Recovery recovery_;
    std::optional<Journal> journal_;
    CheckpointWriter writer_;
    TimePoint last_{};
    std::pair<std::uint64_t, std::uint64_t> saved_{};  // transactions and film of the last checkpoint
    bool is_open_ = false;
    std::uint64_t checkpoints_ = 0;
};

}  // namespace tessera::master
