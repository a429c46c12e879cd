#include "tests/bench/transport/luminance_histogram.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "mediator/picture/color.h"

namespace tessera::tools::bench {

LuminanceHistogram::LuminanceHistogram(const frame::Image& picture) {
    for (std::size_t i = 0; i + 2 < picture.values.size(); i += 3) {
        add(picture::luminance(double(picture.values[i]), double(picture.values[i + 1]),
                               double(picture.values[i + 2])));
    }
}

void LuminanceHistogram::add(double luminance) {
    if (!(luminance > 0.0)) {
        ++black_;
        return;
    }
    const int exponent =
        std::isfinite(luminance) ? std::clamp(std::ilogb(luminance), First, End - 1) : End - 1;
    ++bins_[static_cast<std::size_t>(exponent - First)];
}

void LuminanceHistogram::merge(const LuminanceHistogram& other) {
    for (std::size_t i = 0; i < bins_.size(); ++i) bins_[i] += other.bins_[i];
    black_ += other.black_;
}

std::uint64_t LuminanceHistogram::samples() const {
    return std::accumulate(bins_.begin(), bins_.end(), black_);
}

double LuminanceHistogram::light_in_brightest(double share) const {
    double left = share * double(samples()), found = 0.0, all = 0.0;
    for (int exponent = End - 1; exponent >= First; --exponent) {
        const auto count = double(bins_[static_cast<std::size_t>(exponent - First)]);
        // The mean of 2^x over x in [exponent, exponent + 1).
        const double luminance = std::ldexp(std::numbers::log2e, exponent);
        const double taken = std::min(count, left);
        left -= taken;
        found += taken * luminance;
        all += count * luminance;
    }
    return all > 0.0 ? found / all : 0.0;
}

}  // namespace tessera::tools::bench
