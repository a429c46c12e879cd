#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace tessera::picture {

// 8-bit sRGB of linear light, rounded to nearest as the pow of IEC 61966-2-1 would be, by a table: the
// value's leading bits say a code that is not too large, the threshold to the next code does the rest.
// Below 0 and not a number: 0; above 1: 255.
class SrgbBytes {
  public:
    SrgbBytes();
    std::uint8_t operator()(float linear) const {
        if (!(linear >= Least)) return linear >= thresholds_[0] ? 1 : 0;
        if (linear >= 1.0f) return 255;
        const std::uint8_t code = codes_[(std::bit_cast<std::uint32_t>(linear) >> Shift) - First];
        return static_cast<std::uint8_t>(code + (linear >= thresholds_[code] ? 1 : 0));
    }

  private:
    static constexpr float Least = 0x1p-12f;    // below it codes are 0 and 1
    static constexpr std::uint32_t Shift = 16;  // 128 entries an octave: none holds two thresholds
    static constexpr std::uint32_t First = std::bit_cast<std::uint32_t>(Least) >> Shift;
    std::array<float, 256> thresholds_;  // the least float that rounds to code + 1; the last one: infinity
    std::array<std::uint8_t, 12 * 128> codes_;
};

}  // namespace tessera::picture
