#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace tessera::display {

// Loops over rows work on so many pixels at once: rows have room for the last pack in full.
inline constexpr std::size_t PackSize = 8;
inline constexpr std::size_t padded(std::size_t count) {
    return (count + PackSize - 1) / PackSize * PackSize;
}

// Red, green and blue of a row of pixels, each for itself, padded. Linear light.
struct PlanarRow {
    std::array<float*, 3> planes{};
};

// Rows that one thread works in.
class RowSpace {
  public:
    RowSpace(std::size_t width, std::size_t count)
        : stride_(padded(width)), values_(3 * stride_ * count, 0.0f) {}
    PlanarRow row(std::size_t index) {
        float* first = values_.data() + 3 * stride_ * index;
        return {{first, first + stride_, first + 2 * stride_}};
    }

  private:
    std::size_t stride_;
    std::vector<float> values_;
};

}  // namespace tessera::display
