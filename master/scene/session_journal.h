#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "master/peers/event.h"
#include "master/scene/checkpoint_writer.h"
#include "master/scene/journal.h"
#include "master/scene/recovery.h"

namespace tessera::master {

// A scene session on disk: a journal of its changes and, every `interval`, a checkpoint with the films of its views. The
// journal is used where the authority is used (authority_thread.h); checkpoints are written by another thread.
class SessionJournal {
  public:
    // Locks the folder, restores `authority` from it and records from now on. Throws Error with the folder's name if
    // it is in use or unusable.
    SessionJournal(const std::filesystem::path& folder, Duration interval, SceneAuthority& authority,
                   std::shared_ptr<scene::BlobStore> blobs, EventSink events);

    const Recovery& recovery() const { return recovery_; }
    // The scene was opened: edits are recorded. Throws Error{Io}.
    void opened(const wire::RecordedTitle& scene);
    void closed();
    // A job of the open scene. One whose end cannot be recorded is rendered again after a restart.
    Expected<void> job_started(wire::SavedView view) { return journal_->job_started(std::move(view)); }
    Expected<void> job_ended(const session::JobName& job) { return journal_->job_ended(job); }

    void tick();  // at any time
    bool is_writing() const { return writer_.busy(); }
    bool last_write_failed() const { return last_write_failed_; }
    // True when there are new edits or new film (`film_progress` differs), and none is being written.
    bool has_news(std::uint64_t film_progress) const;
    // The same, when a checkpoint is due: after the interval, or after a second if the journal cannot be written.
    bool wants_checkpoint(std::uint64_t film_progress, TimePoint now) const;
    // Writes the session and these views, which were copied at `film_progress`.
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
    std::shared_ptr<StoredBlobs> stored_;
    std::optional<Journal> journal_;
    CheckpointWriter writer_;
    TimePoint last_{};
    using Progress = std::pair<std::uint64_t, std::uint64_t>;  // transactions and film
    Progress saved_{}, being_saved_{};  // by the last checkpoint; by the one being written
    bool is_open_ = false, last_write_failed_ = false;
    bool lost_ = false;  // to another master
    std::uint64_t checkpoints_ = 0;
    std::uint64_t failures_at_start_ = 0;  // of the disk, when the checkpoint was begun that is being written
};

}  // namespace tessera::master
