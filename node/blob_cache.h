#pragma once

#include <cstdint>
#include <filesystem>

#include "mediator/scene/blob.h"

namespace tessera::node {

// Blobs on disk, so that a restarted node need not fetch them again. Files are named by their hash, written under a
// temporary name and renamed, and verified when read; damaged ones are removed. The least recently used are evicted.
// Write failures only make the cache smaller. Single-threaded.
class BlobCache {
  public:
    // Creates the folder; throws Error{Io}.
    BlobCache(std::filesystem::path folder, std::uint64_t byte_limit);

    scene::BlobPtr load(const scene::BlobRef& blob);  // null when absent or damaged
    void save(const scene::Blob& blob);

  private:
    void shrink();

    std::filesystem::path folder_;
    std::uint64_t byte_limit_;
    std::uint64_t byte_size_ = 0;  // estimate; shrink() recounts
};

}  // namespace tessera::node
