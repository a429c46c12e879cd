#include "mediator/base/hash.h"

#include <sodium.h>

#include <cstring>

namespace tessera {

struct Blake2b::State {
    crypto_generichash_state blake;
};

namespace {

template <std::size_t N>
std::string hex(const std::array<std::byte, N>& bytes) {
    std::string text(2 * N + 1, '\0');
    sodium_bin2hex(text.data(), text.size(), reinterpret_cast<const unsigned char*>(bytes.data()), N);
    text.pop_back();
    return text;
}

}  // namespace

Hash128& Hash128::operator+=(const Hash128& other) {
    low += other.low;
    high += other.high + (low < other.low ? 1 : 0);
    return *this;
}

Hash128& Hash128::operator-=(const Hash128& other) {
    const bool borrow = low < other.low;
    low -= other.low;
    high -= other.high + (borrow ? 1 : 0);
    return *this;
}

Blake2b::Blake2b() : state_(std::make_unique<State>()) {
    crypto_generichash_init(&state_->blake, nullptr, 0, sizeof(Hash256::bytes));
}

Blake2b::~Blake2b() = default;

void Blake2b::update(std::span<const std::byte> data) {
    crypto_generichash_update(&state_->blake, reinterpret_cast<const unsigned char*>(data.data()),
                              data.size());
}

Hash256 Blake2b::finish() {
    Hash256 hash;
    crypto_generichash_final(&state_->blake, reinterpret_cast<unsigned char*>(hash.bytes.data()),
                             hash.bytes.size());
    return hash;
}

Hash256 blake2b(std::span<const std::byte> data) {
    Blake2b hash;
    hash.update(data);
    return hash.finish();
}

Hash128 truncated(const Hash256& hash) {
    Hash128 result;
    std::memcpy(&result.high, hash.bytes.data(), 8);
    std::memcpy(&result.low, hash.bytes.data() + 8, 8);
    return result;
}

std::string to_hex(const Hash256& hash) {
    return hex(hash.bytes);
}

std::string to_hex(const Hash128& hash) {
    std::array<std::byte, 16> bytes{};
    for (std::size_t i = 0; i < 8; ++i) {
        bytes[i] = static_cast<std::byte>(hash.high >> (56 - 8 * i));
        bytes[8 + i] = static_cast<std::byte>(hash.low >> (56 - 8 * i));
    }
    return hex(bytes);
}

}  // namespace tessera
