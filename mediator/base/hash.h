#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <tuple>

#include "mediator/base/description.h"

namespace tessera {

// BLAKE2b-256: identifies a blob, film or scene.
struct Hash256 {
    std::array<std::byte, 32> bytes{};

    friend auto operator<=>(const Hash256&, const Hash256&) = default;
};

// Sums modulo 2^128, so that the hash of a set is updated at the cost of the changed members.
struct Hash128 {
    std::uint64_t high = 0, low = 0;

    Hash128& operator+=(const Hash128& other);
    Hash128& operator-=(const Hash128& other);
    friend auto operator<=>(const Hash128&, const Hash128&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "high", &Hash128::high, FullWidth{}),
                          row(2, "low", &Hash128::low, FullWidth{}));
    }
};

// Streaming BLAKE2b (libsodium). One thread.
class Blake2b {
  public:
    Blake2b();
    ~Blake2b();
    Blake2b(const Blake2b&) = delete;
    Blake2b& operator=(const Blake2b&) = delete;

    void update(std::span<const std::byte> data);
    Hash256 finish();  // once

  private:
    struct State;
    std::unique_ptr<State> state_;
};

Hash256 blake2b(std::span<const std::byte> data);
Hash128 truncated(const Hash256& hash);

std::string to_hex(const Hash256& hash);
std::string to_hex(const Hash128& hash);

}  // namespace tessera

template <>
struct std::hash<tessera::Hash256> {
    std::size_t operator()(const tessera::Hash256& key) const noexcept {
        std::size_t value = 0;
        for (std::size_t i = 0; i < sizeof value; ++i) {
            value |= static_cast<std::size_t>(key.bytes[i]) << (8 * i);
        }
        return value;
    }
};
