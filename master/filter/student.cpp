#include "master/filter/student.h"

#include <algorithm>
#include <cmath>

namespace tessera::filter {

namespace {

// I_x(a, b) by its continued fraction, evaluated from its end with Lentz' method (Abramowitz and Stegun
// 26.5.8); it converges fast for x < (a + 1) / (a + b + 2), the caller ensures that.
double incomplete_beta_fraction(double a, double b, double x) {
    constexpr double Tiny = 1e-300;
    const auto away_from_zero = [](double v) { return std::abs(v) < Tiny ? Tiny : v; };
    double c = 1.0, d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0)), f = d;
    for (int m = 1; m < 10000; ++m) {
        const auto step = [&](double numerator) {
            d = 1.0 / away_from_zero(1.0 + numerator * d);
            c = away_from_zero(1.0 + numerator / c);
            f *= c * d;
        };
        step(m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)));
        step(-(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)));
        if (std::abs(c * d - 1.0) < 1e-14) break;
    }
    return f;
}

double incomplete_beta(double a, double b, double x) {
    if (x <= 0.0) return 0.0;
    if (x >= 1.0) return 1.0;
    const double front =
        std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
    if (x < (a + 1.0) / (a + b + 2.0)) return front * incomplete_beta_fraction(a, b, x) / a;
    return 1.0 - front * incomplete_beta_fraction(b, a, 1.0 - x) / b;
}

// P(|T| > t) = I_{dof / (dof + t^2)}(dof / 2, 1 / 2).
double tails(double t, double dof) {
    if (dof > 1e6) return std::erfc(t / std::sqrt(2.0));
    return incomplete_beta(0.5 * dof, 0.5, dof / (dof + t * t));
}

}  // namespace

double student_quantile(double confidence, double dof) {
    const double wanted = 1.0 - confidence;
    double low = std::log(1e-3), high = std::log(1e6);
    for (int i = 0; i < 60; ++i) {
        const double midpoint = 0.5 * (low + high);
        (tails(std::exp(midpoint), dof) > wanted ? low : high) = midpoint;
    }
    return std::exp(0.5 * (low + high));
}

void StudentSquares::prepare(double confidence) {
    if (confidence == confidence_) return;
    confidence_ = confidence;
    for (std::size_t i = 0; i <= Steps; ++i) {
        const double dof = i == 0 ? 1e9 : static_cast<double>(Steps) / static_cast<double>(i);
        logarithms_[i] = static_cast<float>(2.0 * std::log(student_quantile(confidence, dof)));
    }
}

float StudentSquares::operator()(float dof) const {
    const float at = static_cast<float>(Steps) / std::max(dof, 1.0f);
    const auto i = std::min(static_cast<std::size_t>(at), Steps - 1);
    const float between = at - static_cast<float>(i);
    return std::exp(logarithms_[i] + between * (logarithms_[i + 1] - logarithms_[i]));
}

}  // namespace tessera::filter
