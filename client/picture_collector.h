#pragma once

#include <vector>

#include "mediator/base/error.h"
#include "mediator/wire/messages.h"

namespace tessera::client {

// Puts the pieces of one job's picture together. They come in order, since one link brings them all.
class PictureCollector {
  public:
    explicit PictureCollector(JobId job) : job_(job) {}

    // InvalidInput: the piece does not follow the one before it, or the picture is larger than any frame.
    Expected<void> add(wire::PictureChunk&& chunk);
    std::uint64_t byte_size() const { return bytes_.size(); }
    std::vector<std::byte> take() { return std::move(bytes_); }

  private:
    JobId job_;
    std::vector<std::byte> bytes_;
};

}  // namespace tessera::client
