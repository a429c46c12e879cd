#pragma once

#include <optional>

#include "client/output_event.h"
#include "mediator/base/error.h"
#include "mediator/wire/bulk_messages.h"

namespace tessera::client {

// Assembles the pictures of an output's frame from parts, which arrive in order. A part of a newer frame drops an
// incomplete one.
class OutputCollector {
  public:
    // The frame, with its last piece. An Error when pieces contradict each other.
    Expected<std::optional<OutputFrame>> add(wire::OutputPicture&& piece);

  private:
    std::optional<OutputFrame> frame_;
    std::uint64_t missing_ = 0;  // bytes still missing of the current picture
};

}  // namespace tessera::client
