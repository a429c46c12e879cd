#include "tests/bench/filters/curve.h"

#include <algorithm>
#include <cmath>

namespace tessera::tools::bench {

ErrorCurve::ErrorCurve(std::vector<CurvePoint> points) : points_(std::move(points)) {
    std::erase_if(points_, [](const CurvePoint& p) { return !(p.cost > 0.0) || !(p.error > 0.0); });
    std::sort(points_.begin(), points_.end(),
              [](const CurvePoint& a, const CurvePoint& b) { return a.cost < b.cost; });
}

ErrorCurve::Reading ErrorCurve::error_at(double cost) const {
    if (points_.empty() || !(cost > 0.0)) return {0.0, false};
    if (cost <= points_.front().cost || points_.size() == 1) {
        const CurvePoint& end = points_.front();
        return {end.error * end.cost / cost, cost == end.cost};
    }
    if (cost > points_.back().cost) return {points_.back().error * points_.back().cost / cost, false};
    const auto after =
        std::find_if(points_.begin(), points_.end(), [&](const CurvePoint& p) { return p.cost >= cost; });
    const CurvePoint &a = *(after - 1), &b = *after;
    const double t = std::log(cost / a.cost) / std::log(b.cost / a.cost);
    return {a.error * std::pow(b.error / a.error, t), true};
}

ErrorCurve::Reading ErrorCurve::cost_of(double error) const {
    if (points_.empty() || !(error > 0.0)) return {0.0, false};
    const CurvePoint &first = points_.front(), &last = points_.back();
    if (error < last.error) return {last.cost * last.error / error, false};
    for (std::size_t i = points_.size() - 1; i-- > 0;) {
        const CurvePoint &a = points_[i], &b = points_[i + 1];
        if (error > a.error || a.error <= b.error) continue;
        const double t = std::log(error / a.error) / std::log(b.error / a.error);
        return {a.cost * std::pow(b.cost / a.cost, t), true};
    }
    if (error == last.error) return {last.cost, true};
    return {first.cost * first.error / error, error == first.error};
}

}  // namespace tessera::tools::bench
