#pragma once

#include <optional>
#include <set>

#include "master/scene/disk_sync.h"
#include "master/scene/edit_recorder.h"
#include "master/scene/session_folder.h"

namespace tessera::master {

// Everything that happens to the scene, on disk before it is acknowledged: blobs that an edit refers to
// first, then the edit, each with its author, time and the scene's hash after it. A call is back when the
// operating system has the record: the death of the process loses nothing. The disk has it 100 ms later at
// most: so much a loss of power may cost. What cannot be written is refused, and nothing of it stays. One
// thread.
class Journal final : public EditRecorder {
  public:
    // Begins with a new segment; throws Error{Io} when it cannot be made.
    Journal(const std::filesystem::path& folder, std::shared_ptr<const scene::BlobStore> blobs,
            std::uint64_t segment, Duration sync_interval = std::chrono::milliseconds(100));

    Expected<void> joined(const wire::RecordedEditor& editor) override;
    Expected<void> edited(const RecordedEdit& edit) override;
    void cleared() override;
    Expected<void> opened(const wire::RecordedTitle& scene);
    Expected<void> job_started(wire::SavedView view);
    Expected<void> job_ended(const session::JobName& job);

    // From now on into a new segment, whose number it returns: the checkpoint of that number holds all that
    // was recorded before. Throws Error{Io}; then it goes on as before.
    std::uint64_t start_segment();
    std::uint64_t byte_size() const { return earlier_bytes_ + segment_.byte_size(); }  // of this journal

  private:
    Expected<void> append(const wire::JournalRecord& record);
    Expected<void> keep_blobs(const std::vector<scene::Entry>& entries);
    void sync_folder(const std::filesystem::path& folder);

    const std::filesystem::path folder_;
    std::shared_ptr<const scene::BlobStore> blobs_;
    std::uint64_t number_;
    JournalFile segment_;
    std::uint64_t earlier_bytes_ = 0;
    std::set<Hash256> kept_;
    DiskSync sync_;
};

}  // namespace tessera::master
