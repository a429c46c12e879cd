#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace tessera::display {

// Loops over rows process this many pixels at once: rows are padded to whole packs.
inline constexpr std::size_t PackSize = 8;
inline constexpr std::size_t padded(std::size_t count) {
    return (count + PackSize - 1) / PackSize * PackSize;
}

// Red, green and blue planes of a row of pixels, padded. Linear light.
struct PlanarRow {
    std::array<float*, 3> planes{};
};

// Scratch rows of one thread.
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
