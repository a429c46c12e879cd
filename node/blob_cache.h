#pragma once

#include <cstdint>
#include <filesystem>

#include "mediator/scene/blob.h"

namespace tessera::node {

// Blobs on disk, so that a node that starts again need not fetch them again. A file is named after its hash,
// written under another name first, and verified when it is read; what fails is removed. The least recently
// used go first when there is too much. A cache that cannot be written is a smaller cache, never an error.
// One thread.
class BlobCache {
  public:
    // Makes the folder; throws Error{Io} when it cannot.
    BlobCache(std::filesystem::path folder, std::uint64_t byte_limit);

    scene::BlobPtr load(const scene::BlobRef& blob);  // null when absent or damaged
    void save(const scene::Blob& blob);

  private:
    void shrink();

    std::filesystem::path folder_;
    std::uint64_t byte_limit_;
    std::uint64_t byte_size_ = 0;  // as far as we know; shrink() counts anew
};

}  // namespace tessera::node
