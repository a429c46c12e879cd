#pragma once

#include <cstdint>

namespace tessera {

// SplitMix64's finaliser (Steele et al. 2014): a bijection whose output bits all depend on all input bits.
constexpr std::uint64_t mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

// Counter-based: the k-th number of a stream is a pure function, so there is no state to store or restore.
class CounterRandom {
  public:
    constexpr explicit CounterRandom(std::uint64_t seed, std::uint64_t stream = 0)
        : key_(mix(seed + 0x9e3779b97f4a7c15ull) ^ mix(stream + 0x632be59bd9b4e019ull)) {}

    constexpr std::uint64_t bits() { return mix(key_ + 0x9e3779b97f4a7c15ull * ++counter_); }
    constexpr double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }  // [0, 1)
    constexpr std::uint64_t below(std::uint64_t n) {
        return bits() % n;
    }  // n far below 2^64: bias < n / 2^64

  private:
    std::uint64_t key_;
    std::uint64_t counter_ = 0;
};

}  // namespace tessera
