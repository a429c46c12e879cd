#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "master/scene/journal_file.h"

namespace tessera::master {

// Where a session's files lie: journal-NNNNNN (see journal.h), checkpoint-NNNNNN (checkpoint.h), blobs/ by
// hash. Checkpoint N holds everything that was recorded before segment N.
struct SessionFiles {
    std::vector<std::uint64_t> journals, checkpoints;  // ascending
};
SessionFiles session_files(const std::filesystem::path& folder);  // throws Error{Io} when it cannot be read
std::filesystem::path journal_path(const std::filesystem::path& folder, std::uint64_t number);
std::filesystem::path checkpoint_path(const std::filesystem::path& folder, std::uint64_t number);
std::filesystem::path blobs_path(const std::filesystem::path& folder);

// Has the folder made and to itself: throws Error{Unavailable} while another master has it, Error{Io} when it
// cannot be used.
class SessionFolder {
  public:
    explicit SessionFolder(std::filesystem::path path);
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
    FilePtr lock_;
};

// Removes checkpoints but the last two, and the journal before the older one. What fails stays.
void remove_outdated(const std::filesystem::path& folder);

// Forces a file or a folder's list of files to the disk; throws Error{Io}.
void force_to_disk(const std::filesystem::path& path);

}  // namespace tessera::master
