#pragma once

#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "master/scene/authority_state.h"
#include "master/scene/folder_lease.h"
#include "master/scene/stored_blobs.h"

namespace tessera::master {

// The content of a checkpoint. Taking it costs the loop a copy of the scene's map; the writer encodes and writes it.
struct CheckpointJob {
    std::uint64_t number = 0;  // Journal::start_segment(), called right before the state was taken
    wire::RecordedTitle scene;
    AuthorityState authority;  // SceneAuthority::save()
    std::vector<wire::SavedView> views;
};

struct CheckpointResult {
    std::uint64_t number = 0, byte_size = 0;
    double seconds = 0;
    std::string problem;  // empty = it is on disk, and outdated files are removed
};

// Writes checkpoints into a session folder, one at a time, on a background thread, and removes files that are not needed
// any more.
class CheckpointWriter {
  public:
    explicit CheckpointWriter(std::filesystem::path folder, std::shared_ptr<StoredBlobs> stored = nullptr,
                              std::shared_ptr<FolderLease> lease = nullptr);
    ~CheckpointWriter();  // waits for the one being written
    CheckpointWriter(const CheckpointWriter&) = delete;
    CheckpointWriter& operator=(const CheckpointWriter&) = delete;

    bool busy() const;
    void start(CheckpointJob job);                  // not while busy
    void wait();                                    // until not busy
    std::optional<CheckpointResult> take_result();  // of the latest, once

  private:
    void run(const std::stop_token& stop);
    CheckpointResult write(CheckpointJob job) const;
    void check_lease() const;  // throws Error{Unavailable} when another master records in the folder

    const std::filesystem::path folder_;
    const std::shared_ptr<StoredBlobs> stored_;
    const std::shared_ptr<FolderLease> lease_;
    mutable std::mutex mutex_;  // protects the three below
    std::optional<CheckpointJob> job_;
    std::optional<CheckpointResult> result_;
    bool busy_ = false;
    std::condition_variable_any changed_;
    std::jthread thread_;
};

}  // namespace tessera::master
