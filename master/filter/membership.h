#pragma once

// Which pairs of pixels have statistically indistinguishable means: Welch's interval of the difference of two
// means,
//
//     d^2 <= t^2(dof) (V_p + V_q),    1 / dof = s^2 / dof_p + (1 - s)^2 / dof_q,   s = V_p / (V_p + V_q)
//
// in a form that costs a few operations per pair. For equal numbers of samples 1 / dof is (1 - 2 s (1 - s)) /
// dof_p, so t^2 goes from t^2(dof_p) at s = 0, 1 to t^2(2 dof_p) at s = 1/2. It is interpolated linearly in s
// (1 - s): exact at both ends and, since t^2 is convex, slightly too large in between. Unequal numbers of
// samples: averaged with weights V.
namespace tessera::filter {

struct Quantile {
    float square;  // t^2(dof)
    float credit;  // 2 (t^2(dof) - t^2(2 dof))
};

// For holes, with a square of 1 and a credit of 0: an interval that contains everything.
inline constexpr float UnknownVariance = 1e37f;

// The square of the interval's half width: p and q are indistinct if (m_p - m_q)^2 is no larger. Variances
// are of the means. Symmetric. No branches, for inner loops.
inline float squared_interval(float variance_p, float variance_q, Quantile p, Quantile q) {
    const float balance = variance_p * (variance_q / (variance_p + variance_q + 1e-37f));
    return p.square * variance_p + q.square * variance_q - (p.credit + q.credit) * balance;
}

}  // namespace tessera::filter
