#pragma once

#include <optional>
#include <vector>

#include "client/frame.h"
#include "mediator/base/error.h"
#include "mediator/frame/tile_film.h"
#include "mediator/wire/messages.h"

namespace tessera::client {

// Assembles a frame from its header, picture chunks and tiles, which arrive in order. Memory is allocated for received
// data only, not by the sizes in the header.
class FrameCollector {
  public:
    void begin(const wire::FrameHeader& header);  // drops an incomplete frame
    // InvalidInput: it contradicts the header or earlier parts. Parts of other frames are ignored.
    Expected<void> add(wire::PictureChunk&& chunk);
    Expected<void> add(wire::FrameTile&& tile);
    Expected<void> add(wire::FilmBlock&& block);
    // The frame, once it is complete.
    std::optional<Frame> take();

  private:
    // Whose blocks arrive one after another.
    struct BlocksOfTile {
        std::uint32_t index = 0, left = 0;
        Rect rect;
        frame::ChannelSet channels;
        frame::TileFilm film{};
    };

    std::optional<wire::FrameHeader> header_;
    std::vector<std::byte> picture_;
    std::optional<frame::FilmState> state_;  // once a block has arrived
    std::optional<BlocksOfTile> tile_;
    std::vector<frame::FilmTile> tiles_;  // until there are enough to allocate the whole film
    std::optional<frame::FilmTile> film_;
    std::vector<bool> seen_;  // tiles, by index
    std::uint32_t tile_count_ = 0;
    std::size_t pixel_count_ = 0;  // of the tiles that have come
};

}  // namespace tessera::client
