#pragma once

#include <array>
#include <cstddef>

// Quantiles of Student's distribution, for confidence intervals of means of few samples.
namespace tessera::filter {

// The t with P(|T| <= t) = confidence for `dof` >= 1 degrees of freedom; relative error below 1e-6.
// confidence in [0.01, 0.99999]. The normal quantile above 1e6 degrees.
double student_quantile(double confidence, double dof);

// t^2 for any number of degrees of freedom >= 1 from a table over 1 / dof, computed once per confidence;
// relative error below 1e-3. Fewer than 1 degree counts as 1.
class StudentSquares {
  public:
    void prepare(double confidence);
    float operator()(float dof) const;

  private:
    static constexpr std::size_t Steps = 256;
    std::array<float, Steps + 1> logarithms_{};  // of t^2 at 1 / dof = i / Steps
    double confidence_ = -1.0;
};

}  // namespace tessera::filter
