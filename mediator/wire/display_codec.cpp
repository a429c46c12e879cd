#include "mediator/wire/display_codec.h"

#include "mediator/codec/codec.h"

namespace tessera::wire {

using namespace codec;

namespace {
constexpr std::size_t MaxDescription = std::size_t{16} << 20;
}

std::vector<std::byte> encode(const display::Display& display) {
    return to_bytes(display);
}

Expected<display::Display> decode_display(std::span<const std::byte> bytes) {
    if (bytes.size() > MaxDescription)
        return failure(ErrorCode::InvalidInput, "malformed display: longer than 16 MiB");
    return from_bytes<display::Display>(bytes);
}

}  // namespace tessera::wire
