#include "master/filter/pixel/schedule.h"

#include <algorithm>
#include <array>

namespace tessera::filter::pixel {

std::uint64_t median_count(std::span<const float> counts) {
    constexpr std::size_t Most = 4096;
    std::array<float, Most> some{};
    if (counts.empty()) return 0;
    // An odd step does not alias with rows of even widths.
    const std::size_t step = counts.size() <= Most ? 1 : (counts.size() / Most + 1) | 1;
    std::size_t size = 0;
    for (std::size_t i = 0; i < counts.size() && size < Most; i += step) some[size++] = counts[i];
    const auto center = some.begin() + static_cast<std::ptrdiff_t>(size / 2);
    std::nth_element(some.begin(), center, some.begin() + static_cast<std::ptrdiff_t>(size));
    return static_cast<std::uint64_t>(*center);
}

}  // namespace tessera::filter::pixel
