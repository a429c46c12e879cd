#include "mediator/codec/format.h"

#include <algorithm>

namespace tessera::codec {

namespace {

constexpr std::size_t MaxMessage = std::numeric_limits<std::int32_t>::max();
constexpr std::size_t InitialCapacity = 256;

}  // namespace

void FormatWriter::grow(std::size_t size) {
    bytes_.resize(std::max({InitialCapacity, 2 * bytes_.size(), size_ + size}));
}

void FormatWriter::end(std::size_t start) {
    std::uint64_t length = size_ - start;
    if (length < 0x80) {
        bytes_[start - 1] = static_cast<std::byte>(length);
        return;
    }
    const auto more =
        static_cast<std::size_t>(std::bit_width(length) - 1) / 7;  // bytes in addition to the reserved one
    room(more);
    std::byte* to = bytes_.data() + start - 1;
    std::memmove(to + 1 + more, to + 1, size_ - start);
    size_ += more;
    for (; length >= 0x80; length >>= 7) *to++ = static_cast<std::byte>(length | 0x80);
    *to = static_cast<std::byte>(length);
}

std::vector<std::byte> FormatWriter::take() {
    if (size_ > MaxMessage)
        throw Error(ErrorCode::InvalidInput, "a message is longer than 2 GiB: split the edit");
    bytes_.resize(size_);
    size_ = 0;
    return std::exchange(bytes_, {});
}

std::uint32_t FormatReader::tag() {
    if (at_ == end_) return 0;
    enter({});
    const std::uint64_t tag = varint();
    if (tag > std::numeric_limits<std::uint32_t>::max() || tag < 8) fail("a field has no number");
    return static_cast<std::uint32_t>(tag);
}

std::uint64_t FormatReader::long_varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
        if (at_ == end_) fail("it ends too early");
        const auto byte = static_cast<std::uint64_t>(*at_++);
        value |= (byte & 0x7f) << shift;
        if (byte < 0x80) return value;
    }
    fail("a number has too many bytes");
}

void FormatReader::skip(std::uint32_t tag) {
    switch (static_cast<WireType>(tag & 7)) {
        case WireType::Varint:
            varint();
            return;
        case WireType::Fixed64:
            fixed<std::uint64_t>();
            return;
        case WireType::Length:
            block();
            return;
        case WireType::Fixed32:
            fixed<std::uint32_t>();
            return;
    }
    fail("a field is of an unknown type");
}

std::string FormatReader::path() const {
    std::string text = outer_ != nullptr ? outer_->path() : std::string{};
    if (field_.empty()) return text;
    if (!text.empty()) text += '.';
    text += field_;
    if (entry_ != NoEntry) text += '[' + std::to_string(entry_) + ']';
    return text;
}

void FormatReader::fail(std::string_view what) const {
    const std::string place = path();
    throw Error(ErrorCode::InvalidInput,
                "malformed message: " + (place.empty() ? "" : place + ": ") + std::string(what));
}

}  // namespace tessera::codec
