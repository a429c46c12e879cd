#pragma once

#include <optional>
#include <vector>

#include "client/frame.h"
#include "mediator/base/error.h"
#include "mediator/wire/messages.h"

namespace tessera::client {

// Puts one frame together: header, then its picture and tiles, which one link brings in order. Memory is taken for
// what has come, not for what a header says.
class FrameCollector {
  public:
    void begin(const wire::FrameHeader& header);  // whatever was not complete is dropped: its rest is lost
    // InvalidInput: it does not fit the header, or what came before. Pieces of other frames are ignored.
    Expected<void> add(wire::PictureChunk&& chunk);
    Expected<void> add(wire::FrameTile&& tile);
    // Once all of it is here.
    std::optional<Frame> take();

  private:
    std::optional<wire::FrameHeader> header_;
    std::vector<std::byte> picture_;
    std::vector<frame::FilmTile> tiles_;  // until there are enough of them to make room for the whole film
    std::optional<frame::FilmTile> film_;
    std::vector<bool> seen_;  // tiles, by index
    std::uint32_t tile_count_ = 0;
    std::size_t pixel_count_ = 0;  // of the tiles that have come
};

}  // namespace tessera::client
