#include "mediator/wire/display_codec.h"

#include "mediator/wire/display_mapping.h"

namespace tessera::wire {

namespace {
constexpr std::size_t MaxDescription = std::size_t{16} << 20;
}

std::vector<std::byte> encode(const display::Display& display) {
    proto::Display message;
    map(Writer(), display, message);
    std::vector<std::byte> bytes(message.ByteSizeLong());
    message.SerializeToArray(bytes.data(), static_cast<int>(bytes.size()));
    return bytes;
}

Expected<display::Display> decode_display(std::span<const std::byte> bytes) {
    proto::Display message;
    if (bytes.size() > MaxDescription ||
        !message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
        return failure(ErrorCode::InvalidInput, "malformed display: not a description of one");
    try {
        display::Display display;
        map(Reader(), display, message);
        return display;
    } catch (const Error& error) {
        return tl::unexpected(error);
    }
}

}  // namespace tessera::wire
