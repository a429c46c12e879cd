#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace tessera::picture {

// 8-bit sRGB of linear values by table lookup, rounded like the formula of IEC 61966-2-1: the leading bits of the value
// give the code or its predecessor, and a threshold decides. Negative values and NaN give 0, values above 1 give 255.
class SrgbBytes {
  public:
    SrgbBytes();
    std::uint8_t operator()(float linear) const {
        if (!(linear >= MinIndexed)) return linear >= thresholds_[0] ? 1 : 0;
        if (linear >= 1.0f) return 255;
        const std::uint8_t code = codes_[(std::bit_cast<std::uint32_t>(linear) >> Shift) - First];
        return static_cast<std::uint8_t>(code + (linear >= thresholds_[code] ? 1 : 0));
    }

  private:
    static constexpr float MinIndexed = 0x1p-12f;  // below it codes are 0 and 1
    static constexpr std::uint32_t Shift = 16;     // 128 entries an octave: none holds two thresholds
    static constexpr std::uint32_t First = std::bit_cast<std::uint32_t>(MinIndexed) >> Shift;
    std::array<float, 256> thresholds_;  // the smallest float that rounds to code + 1; the last is infinity
    std::array<std::uint8_t, 12 * 128> codes_;
};

}  // namespace tessera::picture
