#pragma once

#include <vector>

namespace tessera::tools::bench {

// Error of the unfiltered picture over what was spent on it (samples or seconds), as measured.
struct CurvePoint {
    double cost = 0.0, error = 0.0;
};

// The curve between its points: straight in the logarithms of both. Beyond them error x cost stays what it is
// at the nearest end: the law of independent samples.
class ErrorCurve {
  public:
    // Points that are not positive are left out.
    explicit ErrorCurve(std::vector<CurvePoint> points);

    struct Reading {
        double value = 0.0;
        bool is_measured = true;  // false: beyond the ends
    };
    // Reading of an empty curve, or at a cost or error that is not positive: 0, not measured.
    Reading error_at(double cost) const;
    Reading cost_of(double error) const;  // where the curve is that low for the last time

  private:
    std::vector<CurvePoint> points_;  // by ascending cost
};

}  // namespace tessera::tools::bench
