#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

namespace tessera::master {

// Predicts the time from the end of a picture's sampling until it is encoded: cancelling units, filter,
// encoding. Learns seconds per pixel for each way of making a picture; the slowest of the
// latest few is the prediction, since being late is worse than a few samples fewer. Pure.
class TimeBudget {
  public:
    // Everything that the time depends on but the number of pixels.
    using CostKey = std::string;

    void measured(const CostKey& cost_key, std::uint64_t pixels, double seconds);
    std::optional<double> predict(const CostKey& cost_key,
                                  std::uint64_t pixels) const;  // seconds; nothing: never measured

  private:
    static constexpr std::size_t Remembered = 8;     // measurements
    static constexpr std::size_t MaxCostKeys = 256;  // clients may name any filter with any values
    std::map<CostKey, std::deque<double>> seconds_per_pixel_;
};

// How much smaller the picture must be rendered (1, 2 or 4 times in each direction) so that `seconds` suffice
// for `least` samples in every pixel at a rate of so many pixel samples per second. An unknown rate (0)
// changes nothing.
std::uint32_t scale_that_fits(std::uint64_t pixels, double seconds, double samples_per_second, double least);

}  // namespace tessera::master
