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

EditSize measure_edit(std::span<const std::byte> bytes) {
    constexpr std::uint32_t EntryTag = make_tag(4, WireType::Length);
    constexpr std::uint64_t Growth = 8;  // a number of one byte takes eight
    EditSize size{.bytes = Growth * bytes.size()};
    try {
        FormatReader in(bytes);
        while (const std::uint32_t tag = in.tag()) {
            in.skip(tag);
            size.entries += tag == EntryTag ? 1 : 0;
        }
    } catch (const Error&) {
        // Decoding stops there as well.
    }
    size.bytes += size.entries * sizeof(scene::Entry);
    return size;
}

Expected<scene::Edit> decode_edit(std::span<const std::byte> bytes) {
    const EditSize size = measure_edit(bytes);
    if (size.entries > scene::MaxEditEntries) {
        return failure(ErrorCode::InvalidInput,
                       "an edit of " + std::to_string(size.entries) + " entries is longer than one may be, " +
                           std::to_string(scene::MaxEditEntries) + ": make it in parts");
    }
    try {
        scene::Edit edit;
        edit.entries.reserve(size.entries);
        FormatReader in(bytes);
        read_content(in, edit);
        return edit;
    } catch (const Error& error) {
        return tl::unexpected(error);
    }
}

}  // namespace tessera::wire
