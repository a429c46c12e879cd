#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/wire/messages.h"

namespace tessera::wire {

// Encoding of the control link. Decoding accepts arbitrary bytes: data that is malformed, out of range, over a limit of
// entries or of another protocol is an Error{InvalidInput} with the reason. Content never causes an exception.
std::vector<std::byte> encode(const ControlMessage& message);
Expected<ControlMessage> decode_control(std::span<const std::byte> bytes);

// Bytes of the bulk link.
std::vector<std::byte> encode(const BulkMessage& message);
Expected<BulkMessage> decode_bulk(std::span<const std::byte> bytes);
// Whether the header of these bytes is that of a bulk message.
bool is_bulk(std::span<const std::byte> bytes);
// Whether the header is that of a node's film; lets an event loop forward film without decoding it.
bool is_film(std::span<const std::byte> bytes);
// What film is of, without its planes, which are not looked at.
struct FilmHead {
    UnitId unit;
    ViewId view;
    std::uint64_t revision = 0;
    Version version;
    Rect rect;
    frame::SampleBlock block;
    std::string mask;  // as WorkUnit's
};
Expected<FilmHead> film_head(std::span<const std::byte> bytes);

// Content of blobs that hold scene changes.
std::vector<std::byte> encode(const scene::ChangeList& changes);
Expected<scene::ChangeList> decode_change_list(std::span<const std::byte> bytes);
std::vector<std::byte> encode(const scene::Edit& edit);
// An edit of more than scene::MaxEditEntries is an Error{InvalidInput} that says so, before it takes memory.
Expected<scene::Edit> decode_edit(std::span<const std::byte> bytes);
// What an encoded edit holds, without decoding it: its entries, and the bytes of memory that it takes at most.
struct EditSize {
    std::uint64_t entries = 0, bytes = 0;
};
EditSize measure_edit(std::span<const std::byte> bytes);

// Whether an encoded message fits the control link (64 KiB); else send its content as a blob.
bool fits_control(std::span<const std::byte> encoded);
// Whether a message with so many entries may fit: each takes 4 bytes or more. What may not need not be encoded to
// be measured.
bool may_fit_control(std::size_t entries);

}  // namespace tessera::wire
