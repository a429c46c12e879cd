#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/tools/tev/packets.h"
#include "mediator/base/error.h"
#include "mediator/picture/exr_writer.h"

namespace tessera::tools::tev {

inline constexpr const char* DefaultPort = "14158";

// InvalidInput unless it is HOST, HOST:PORT or [HOST]:PORT.
Expected<void> check_address(const std::string& address);

// A picture of this process in the image viewer tev, which may run on another machine. Only what has changed is sent.
class Viewer {
  public:
    // Throws Error: InvalidInput for an address of another form, Unavailable if no viewer listens there.
    Viewer(const std::string& address, std::string image);
    ~Viewer();
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;

    // Shows these layers, all of one size. Returns, once, why this and later pictures are not shown: the viewer has gone, or it
    // takes nothing for ten seconds.
    std::optional<std::string> show(std::span<const picture::Layer> layers);

  private:
    bool send(const Packet& packet);

    std::string address_, image_;
    int socket_ = -1;  // -1 as well when the viewer has gone
    std::uint32_t width_ = 0, height_ = 0;
    std::vector<std::string> channels_;
    std::vector<float> shown_;  // one plane after another
};

// Parts of a picture that are sent as one packet.
inline constexpr std::uint32_t TileSize = 64;

}  // namespace tessera::tools::tev
