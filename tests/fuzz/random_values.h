#pragma once

#include <array>
#include <string>

#include "mediator/base/random.h"

namespace tessera::test {

// The random numbers of one peer.
class RandomValues {
  public:
    explicit RandomValues(std::uint64_t seed) : random_(seed, 0) {}

    CounterRandom& stream() { return random_; }
    std::uint64_t below(std::uint64_t n) { return random_.below(n); }
    bool chance(unsigned percent) { return random_.below(100) < percent; }
    std::uint64_t extreme() {  // often at an edge
        constexpr auto Edges = std::to_array<std::uint64_t>(
            {0, 1, 2, 255, 65535, 65536, 0x7fffffff, 0xffffffff, ~0ull >> 1, ~0ull});
        return chance(50) ? below(64) : Edges[below(Edges.size())];
    }
    // Mostly short; at times longer than names may be, or than what fits into one message with others.
    std::string name(const std::string& usual) {
        if (!chance(6)) return usual;
        constexpr auto Sizes = std::to_array<std::size_t>({256, 257, 4'000, 60'000, 65'000});
        return std::string(Sizes[below(Sizes.size())], 'n');
    }

  private:
    CounterRandom random_;
};

}  // namespace tessera::test
