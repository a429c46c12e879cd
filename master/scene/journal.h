#pragma once

#include <memory>

#include "master/scene/disk_sync.h"
#include "master/scene/edit_recorder.h"
#include "master/scene/session_folder.h"
#include "master/scene/stored_blobs.h"

namespace tessera::master {

// Writes every change of the scene to disk before it is acknowledged: first the blobs that an edit refers to,
// then the edit with its author, time and the scene's hash after it. A call returns when the operating system has
// the record, so a crash of the process loses nothing. The disk is synced at most 100 ms later, which is what a
// power failure may lose. An edit that cannot be written is refused and leaves nothing behind, and so is
// one when another master has taken over the folder. Single-threaded.
class Journal final : public EditRecorder {
  public:
    // Begins with a new segment; throws Error{Io} if it cannot be created.
    Journal(const std::filesystem::path& folder, std::shared_ptr<const scene::BlobStore> blobs,
            std::uint64_t segment, std::shared_ptr<StoredBlobs> stored = nullptr,
            std::shared_ptr<FolderLease> lease = nullptr,
            Duration sync_interval = std::chrono::milliseconds(100));

    Expected<void> joined(const wire::RecordedEditor& editor) override;
    Expected<void> edited(const RecordedEdit& edit) override;
    void cleared() override;
    Expected<void> opened(const wire::RecordedTitle& scene);
    Expected<void> job_started(wire::SavedView view);
    Expected<void> job_ended(const session::JobName& job);

    // Starts a new segment and returns its number: the checkpoint of that number contains everything recorded
    // before. Throws Error{Io}, or Error{Unavailable} when another master records in the folder, and then keeps using
    // the old segment.
    std::uint64_t start_segment();
    // Why nothing is recorded any more; "" = it is. A checkpoint holds everything if no more failures followed its start:
    // recovered().
    std::string problem() const { return sync_.problem(); }
    std::uint64_t failures() const { return sync_.failures(); }
    void recovered() { sync_.forget_problem(); }
    std::uint64_t byte_size() const { return earlier_bytes_ + segment_.byte_size(); }  // of this journal

  private:
    Expected<void> append(const wire::JournalRecord& record);
    Expected<void> keep_blobs(const std::vector<scene::Entry>& entries);
    Expected<void> check_disk() const;
    void sync_folder(const std::filesystem::path& folder, std::function<void()> failed = {});

    const std::filesystem::path folder_;
    std::shared_ptr<const scene::BlobStore> blobs_;
    std::uint64_t number_;
    JournalFile segment_;
    std::uint64_t earlier_bytes_ = 0;
    const std::shared_ptr<StoredBlobs> stored_;
    const std::shared_ptr<FolderLease> lease_;  // null: not asked
    DiskSync sync_;
};

}  // namespace tessera::master
