#include "client/tools/tev/packets.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <utility>

namespace tessera::tools::tev {

namespace {

static_assert(std::endian::native == std::endian::little);

// UpdateStrided: each channel has the offset of its first value and the distance from value to value.
enum class Kind : std::uint8_t { Create = 4, UpdateStrided = 6 };

class Writer {
  public:
    explicit Writer(Kind kind) {
        put(std::uint32_t{0});  // the length, once it is known
        put(kind);
    }
    template <class Number>
    void put(Number number) {
        const auto bytes = std::bit_cast<std::array<std::byte, sizeof(Number)>>(number);
        packet_.insert(packet_.end(), bytes.begin(), bytes.end());
    }
    void put(const std::string& text) {
        for (const char c : text) put(c);
        put('\0');
    }
    void put(std::span<const float> values) {
        const auto bytes = std::as_bytes(values);
        packet_.insert(packet_.end(), bytes.begin(), bytes.end());
    }
    Packet take() {
        const auto size = static_cast<std::uint32_t>(packet_.size());
        std::memcpy(packet_.data(), &size, sizeof size);
        return std::move(packet_);
    }

  private:
    Packet packet_;
};

constexpr std::uint8_t KeepsSelection = 0;  // the viewer does not switch to the picture

}  // namespace

Packet create_image(const std::string& name, std::uint32_t width, std::uint32_t height,
                    std::span<const std::string> channels) {
    Writer writer(Kind::Create);
    writer.put(std::uint8_t{1});  // the viewer shows it
    writer.put(name);
    writer.put(static_cast<std::int32_t>(width));
    writer.put(static_cast<std::int32_t>(height));
    writer.put(static_cast<std::int32_t>(channels.size()));
    for (const std::string& channel : channels) writer.put(channel);
    return writer.take();
}

Packet update_image(const std::string& name, std::span<const std::string> channels, const Rect& part,
                    std::span<const float> planes) {
    Writer writer(Kind::UpdateStrided);
    writer.put(KeepsSelection);
    writer.put(name);
    writer.put(static_cast<std::int32_t>(channels.size()));
    for (const std::string& channel : channels) writer.put(channel);
    for (const std::int32_t number : {part.x, part.y, part.width, part.height}) writer.put(number);
    for (std::size_t i = 0; i < channels.size(); ++i)
        writer.put(static_cast<std::int64_t>(i * part.pixel_count()));
    for (std::size_t i = 0; i < channels.size(); ++i) writer.put(std::int64_t{1});
    writer.put(planes);
    return writer.take();
}

}  // namespace tessera::tools::tev
