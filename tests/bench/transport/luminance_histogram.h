#pragma once

#include <array>
#include <cstdint>

#include "mediator/frame/image.h"

namespace tessera::tools::bench {

// How many samples have which luminance, by powers of two: shows heavy tails, which variances hide. Histograms of
// disjoint samples merge exactly, in any order.
class LuminanceHistogram {
  public:
    // Exponents of the first bin and after the last; what is outside is in these.
    static constexpr int First = -32, End = 32;

    LuminanceHistogram() = default;
    // Each pixel is a sample.
    explicit LuminanceHistogram(const frame::Image& picture);

    // Negative and NaN count as black.
    void add(double luminance);
    void merge(const LuminanceHistogram& other);

    // Samples from 2^(First + i) to below twice that.
    const std::array<std::uint64_t, End - First>& bins() const { return bins_; }
    std::uint64_t black() const { return black_; }
    std::uint64_t samples() const;

    // Share of the light in the brightest `share` of the samples, in [0, 1]: luminances are taken to be spread evenly
    // over the exponents of their bin. 0 without light.
    double light_in_brightest(double share) const;

  private:
    std::array<std::uint64_t, End - First> bins_{};
    std::uint64_t black_ = 0;
};

}  // namespace tessera::tools::bench
