#include "mediator/wire/entry_codec.h"
#include "mediator/wire/envelope.h"

namespace tessera::wire {

using namespace codec;

namespace {

constexpr std::size_t ControlBytes = 64 * 1024;

}  // namespace

std::vector<std::byte> encode(const ControlMessage& message) {
    return to_bytes(message);
}

bool fits_control(std::span<const std::byte> encoded) {
    return encoded.size() <= ControlBytes;
}

bool may_fit_control(std::size_t entries) {
    constexpr std::size_t LeastEntry = 4;  // bytes
    return entries * LeastEntry <= ControlBytes;
}

Expected<ControlMessage> decode_control(std::span<const std::byte> bytes) {
    if (!fits_control(bytes))
        return failure(ErrorCode::InvalidInput, "malformed message: longer than 64 KiB");
    return from_bytes<ControlMessage>(bytes);
}

std::vector<std::byte> encode(const scene::ChangeList& changes) {
    return to_bytes(changes);
}

Expected<scene::ChangeList> decode_change_list(std::span<const std::byte> bytes) {
    return from_bytes<scene::ChangeList>(bytes);
}

std::vector<std::byte> encode(const scene::Edit& edit) {
    return to_bytes(edit);
}

Expected<scene::Edit> decode_edit(std::span<const std::byte> bytes) {
    return from_bytes<scene::Edit>(bytes);
}

}  // namespace tessera::wire
