#pragma once

#include <vector>

namespace tessera::tools::bench {

// Error of the unfiltered picture over its cost (samples or seconds), as measured.
struct CurvePoint {
    double cost = 0.0, error = 0.0;
};

// Linear interpolation in log-log space. Beyond the ends error x cost is constant, as for independent
// samples.
class ErrorCurve {
  public:
    // Points that are not positive are skipped.
    explicit ErrorCurve(std::vector<CurvePoint> points);

    struct Reading {
        double value = 0.0;
        bool is_measured = true;  // false: beyond the ends
    };
    // Reading of an empty curve, or at a cost or error that is not positive: 0, not measured.
    Reading error_at(double cost) const;
    Reading cost_of(double error) const;  // the last point where the curve has this error

  private:
    std::vector<CurvePoint> points_;  // by ascending cost
};

}  // namespace tessera::tools::bench
