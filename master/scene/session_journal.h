#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "master/peers/event.h"
#include "master/scene/checkpoint_writer.h"
#include "master/scene/journal.h"
#include "master/scene/recovery.h"

namespace tessera::master {

// A scene session on disk: what happens to it, as it happens, and every `interval` all of it with the films of
// its views. Lives in the render master's loop, which it never holds for longer than a copy of the scene's
// map: files are written by a thread of their own.
class SessionJournal {
  public:
    // Takes the folder, brings `authority` to what its last master left there, and records from now on.
    // Throws Error, naming the folder, when it is in use or of no use.
    SessionJournal(const std::filesystem::path& folder, Duration interval, SceneAuthority& authority,
                   std::shared_ptr<scene::BlobStore> blobs, EventSink events);

    const Recovery& recovery() const { return recovery_; }
    // The scene is open: edits are recorded. Throws Error{Io} when they cannot be.
    void opened(const wire::RecordedTitle& scene);
    void closed();
    // A job of the open scene. Throws Error{Io} when it cannot be recorded.
    void job_started(wire::SavedView view);
    void job_ended(const session::JobName& job);

    void tick();
    // It is time for a checkpoint, and there is something new: edits, or film (`film_progress` differs).
    bool wants_checkpoint(std::uint64_t film_progress, TimePoint now) const;
    // The session as it is now goes to disk with these views, which were copied when `film_progress` was so.
    void write_checkpoint(const wire::RecordedTitle& scene, std::vector<wire::SavedView>&& views,
                          std::uint64_t film_progress, TimePoint now);

    std::uint64_t byte_size() const { return journal_->byte_size(); }
    std::uint64_t checkpoints() const { return checkpoints_; }

  private:
    SessionFolder folder_;
    Duration interval_;
    SceneAuthority& authority_;
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
