#pragma once

#include <optional>

#include "client/output_event.h"
#include "mediator/base/error.h"
#include "mediator/wire/bulk_messages.h"

namespace tessera::client {

// Puts the pieces of a frame's pictures together; they come in order. A piece of a newer frame drops what was
// not complete: its rest is lost.
class OutputCollector {
  public:
    // The frame, with its last piece. An Error when pieces contradict each other.
    Expected<std::optional<OutputFrame>> add(wire::OutputPicture&& piece);

  private:
    std::optional<OutputFrame> frame_;
    std::uint64_t missing_ = 0;  // bytes of the picture under way
};

}  // namespace tessera::client
