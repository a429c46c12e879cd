#include "mediator/picture/srgb_bytes.h"

#include <cmath>
#include <limits>

namespace tessera::picture {

namespace {

double linear_from_srgb(double code) {
    return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
}

}  // namespace

SrgbBytes::SrgbBytes() {
    thresholds_.back() = std::numeric_limits<float>::infinity();
    for (std::size_t code = 0; code + 1 < thresholds_.size(); ++code) {
        const double limit = linear_from_srgb((static_cast<double>(code) + 0.5) / 255.0);
        auto threshold = static_cast<float>(limit);
        if (double{threshold} < limit) threshold = std::nextafter(threshold, 1.0f);
        thresholds_[code] = threshold;
    }
    std::uint8_t code = 0;
    for (std::size_t i = 0; i < codes_.size(); ++i) {
        const auto from = std::bit_cast<float>((First + static_cast<std::uint32_t>(i)) << Shift);
        while (code < 255 && from >= thresholds_[code]) ++code;
        codes_[i] = code;
    }
}

}  // namespace tessera::picture
