#pragma once

#include <optional>
#include <vector>

#include "client/live_session.h"
#include "client/picture_collector.h"
#include "mediator/base/error.h"
#include "mediator/wire/messages.h"

namespace tessera::client {

// Puts one frame of a live view together: header, then its picture and tiles, which one link brings in order.
class FrameCollector {
  public:
    void begin(const wire::LiveFrame& header);  // whatever was not complete is dropped: its rest is lost
    Expected<void> add(wire::PictureChunk&& chunk);
    Expected<void> add(wire::FrameTile&& tile);
    // Once all of it is here.
    std::optional<Frame> take();

  private:
    std::optional<wire::LiveFrame> header_;
    PictureCollector picture_{JobId{}};
    std::vector<frame::FilmTile> tiles_;
};

}  // namespace tessera::client
