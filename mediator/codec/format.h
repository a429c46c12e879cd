#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mediator/base/error.h"

// The Protocol Buffers encoding, as far as proto3 needs it: tags, varints, fixed-width numbers and lengths. No allocation
// depends on a number that was read.
namespace tessera::codec {

static_assert(std::endian::native == std::endian::little,
              "fixed-width numbers are copied without conversion");

enum class WireType : std::uint32_t { Varint = 0, Fixed64 = 1, Length = 2, Fixed32 = 5 };

constexpr std::uint32_t make_tag(unsigned number, WireType type) {
    return (number << 3) | static_cast<std::uint32_t>(type);
}

constexpr std::uint64_t zigzag(std::int64_t value) {
    return (static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63);
}
constexpr std::int64_t unzigzag(std::uint64_t value) {
    return static_cast<std::int64_t>((value >> 1) ^ (~(value & 1) + 1));
}

// Appends to one buffer. The length of a nested message is written when it is complete: one byte is reserved for it, and
// the message is moved if more are needed.
class FormatWriter {
  public:
    void varint(std::uint64_t value) {
        std::byte* to = room(MaxVarint);
        while (value >= 0x80) {
            *to++ = static_cast<std::byte>(value | 0x80);
            value >>= 7;
        }
        *to++ = static_cast<std::byte>(value);
        size_ = static_cast<std::size_t>(to - bytes_.data());
    }
    template <class T>
    void fixed(T value) {
        raw(&value, sizeof value);
    }
    void raw(const void* data, std::size_t size) {
        if (size == 0) return;
        std::memcpy(room(size), data, size);
        size_ += size;
    }
    void block(std::uint32_t tag, const void* data, std::size_t size) {
        varint(tag);
        varint(size);
        raw(data, size);
    }
    // Between begin and end, the content of the message is written.
    std::size_t begin(std::uint32_t tag) {
        varint(tag);
        room(1);
        return ++size_;
    }
    void end(std::size_t start);
    // Throws Error{InvalidInput} when it is longer than protobuf allows.
    std::vector<std::byte> take();

  private:
    static constexpr std::size_t MaxVarint = 10;
    std::byte* room(std::size_t size) {
        if (bytes_.size() - size_ < size) grow(size);
        return bytes_.data() + size_;
    }
    void grow(std::size_t size);

    std::vector<std::byte> bytes_;  // used up to size_
    std::size_t size_ = 0;
};

// Reads one message. Throws Error{InvalidInput} that names the field, from the outermost message on.
class FormatReader {
  public:
    explicit FormatReader(std::span<const std::byte> bytes) : at_(bytes.data()), end_(at_ + bytes.size()) {}
    FormatReader(std::span<const std::byte> bytes, const FormatReader& outer) : FormatReader(bytes) {
        outer_ = &outer;
    }

    std::uint32_t tag();  // 0 at the end
    std::uint64_t varint() {
        if (at_ != end_ && *at_ < std::byte{0x80}) return static_cast<std::uint64_t>(*at_++);
        return long_varint();
    }
    template <class T>
    T fixed() {
        if (static_cast<std::size_t>(end_ - at_) < sizeof(T)) fail("it ends too early");
        T value;
        std::memcpy(&value, at_, sizeof value);
        at_ += sizeof value;
        return value;
    }
    std::span<const std::byte> block() {
        const std::uint64_t size = varint();
        if (size > static_cast<std::uint64_t>(end_ - at_)) fail("it ends too early");
        const std::span<const std::byte> bytes(at_, static_cast<std::size_t>(size));
        at_ += size;
        return bytes;
    }
    void skip(std::uint32_t tag);
    bool at_end() const { return at_ == end_; }

    // The current field, for error messages.
    void enter(std::string_view field) {
        field_ = field;
        entry_ = NoEntry;
    }
    void enter_entry(std::size_t entry) { entry_ = entry; }
    [[noreturn]] void fail(std::string_view what) const;

  private:
    static constexpr std::size_t NoEntry = std::numeric_limits<std::size_t>::max();
    std::uint64_t long_varint();
    std::string path() const;

    const std::byte* at_;
    const std::byte* end_;
    const FormatReader* outer_ = nullptr;
    std::string_view field_;
    std::size_t entry_ = NoEntry;
};

}  // namespace tessera::codec
