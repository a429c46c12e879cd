#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "master/scene/folder_lease.h"
#include "master/scene/journal_file.h"

namespace tessera::master {

// A session's files: journal-NNNNNN (see journal.h), checkpoint-NNNNNN (checkpoint.h), blobs/ by
// hash. Checkpoint N holds everything that was recorded before segment N.
struct SessionFiles {
    std::vector<std::uint64_t> journals, checkpoints;  // ascending
};
SessionFiles session_files(const std::filesystem::path& folder);  // throws Error{Io} if it cannot be read
std::filesystem::path journal_path(const std::filesystem::path& folder, std::uint64_t number);
std::filesystem::path checkpoint_path(const std::filesystem::path& folder, std::uint64_t number);
std::filesystem::path blobs_path(const std::filesystem::path& folder);

// Creates and locks the folder, takes its lease (folder_lease.h), and removes what interrupted writes have left, and damaged files that a recovery kept
// more than a week ago: throws Error{Unavailable} while another master uses it, Error{Io} if it cannot be
// used.
class SessionFolder {
  public:
    explicit SessionFolder(std::filesystem::path path);
    const std::filesystem::path& path() const { return path_; }
    const std::shared_ptr<FolderLease>& lease() const { return lease_; }

  private:
    std::filesystem::path path_;
    FilePtr lock_;
    std::shared_ptr<FolderLease> lease_;
};

// Removes all but the last two checkpoints, and the journal before the older of them. Files that cannot be removed
// are left.
void remove_outdated(const std::filesystem::path& folder);

void remove_leftovers(const std::filesystem::path& folder);  // as above

// Calls fsync on a file or folder; throws Error{Io}.
void force_to_disk(const std::filesystem::path& path);

}  // namespace tessera::master
