#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "mediator/base/error.h"

// Little-endian numbers, one after another. The reader is bounds-checked and throws Error{InvalidInput}.
namespace tessera::codec {

class ByteWriter {
  public:
    explicit ByteWriter(std::size_t expected) { bytes_.reserve(expected); }
    template <class T>
    requires std::is_trivially_copyable_v<T>
    void put(const T& value) { put_all(std::span(&value, 1)); }
    template <class T, std::size_t N>
    void put_all(std::span<T, N> values) {
        const auto raw = std::as_bytes(values);
        bytes_.insert(bytes_.end(), raw.begin(), raw.end());
    }
    std::vector<std::byte> take() { return std::move(bytes_); }

  private:
    std::vector<std::byte> bytes_;
};

class ByteReader {
  public:
    explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
    template <class T>
    requires std::is_trivially_copyable_v<T> T get() {
        T value;
        fill(std::span(&value, 1));
        return value;
    }
    template <class T>
    void fill(std::span<T> values) {
        if (bytes_.size() < values.size_bytes()) fail("it ends too early");
        if (values.empty()) return;
        std::memcpy(values.data(), bytes_.data(), values.size_bytes());
        bytes_ = bytes_.subspan(values.size_bytes());
    }
    void skip(std::size_t count) {
        if (bytes_.size() < count) fail("it ends too early");
        bytes_ = bytes_.subspan(count);
    }
    std::span<const std::byte> rest() const { return bytes_; }
    [[noreturn]] void fail(const char* what) const {
        throw Error(ErrorCode::InvalidInput, std::string("malformed message: ") + what);
    }

  private:
    std::span<const std::byte> bytes_;
};

}  // namespace tessera::codec
