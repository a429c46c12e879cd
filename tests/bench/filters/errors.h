#pragma once

#include "mediator/frame/image.h"

namespace tessera::tools::bench {

// Two independent pictures of one truth T, with noise a and b: R1 = T + a, R2 = T + b, E[a] = E[b] = E[a b] =
// 0. Then for any picture F that is independent of both
//     E[(F - R1)(F - R2)] = (F - T)^2:
// the product is free of the references' noise. With m = F - (R1 + R2)/2 and d = R1 - R2 it is
//     (F - R1)(F - R2) = m^2 - d^2/4,
// that is, the error against the mean of both minus the noise of that mean. Its variance over the references
// is 2 e^2 v + v^2 with e = F - T and v the variance of either; d^2 m^2 has this expectation for normal noise
// (m and d are independent then) and a larger one for heavier tails, so the sum over pixels of (sum over
// components of w d m)^2 estimates the variance of the sum. An estimate may be negative when the error is
// below what the references can resolve.
class ReferencePair {
  public:
    // Equal sizes, 3 components, finite. Throws Error{InvalidInput} otherwise.
    ReferencePair(frame::Image first, frame::Image second);

    const frame::Image& first() const { return first_; }
    const frame::Image& second() const { return second_; }
    const frame::Image& mean() const { return mean_; }
    double noise_mse() const { return noise_mse_; }        // of one reference: mean of d^2 / 2
    double noise_relmse() const { return noise_relmse_; }  // the same, weighted as relMSE is
    double epsilon() const { return epsilon_; }            // 0.01 (mean luminance)^2, as picture::relmse

  private:
    frame::Image first_, second_, mean_;
    double noise_mse_ = 0.0, noise_relmse_ = 0.0, epsilon_ = 0.0;
};

struct Estimate {
    double value = 0.0;
    double deviation = 0.0;  // standard error due to the references' noise
};

// Over all pixels, and without the TrimmedFraction of the pixels with the largest errors: relMSE weighs
// errors in dark regions more, so that one firefly or the edge of one lamp can dominate the rest. The trimmed
// pixels are chosen for each picture by the error against the mean of both references.
struct RelativeErrors {
    Estimate all, trimmed;
};
inline constexpr double TrimmedFraction = 0.001;

// Mean over pixels and components of (F - R1)(F - R2), and the same over (mean^2 + epsilon). The mean of both
// references replaces the truth in the weight only.
struct SquaredErrors {
    Estimate mse;
    RelativeErrors relmse;
};
SquaredErrors squared_errors(const frame::Image& picture, const ReferencePair& references);

// relMSE of the difference between consecutive pictures against that of the references: flicker counts, a
// constant error does not. Weighted by the second references.
RelativeErrors temporal_relmse(const frame::Image& before, const frame::Image& after,
                               const ReferencePair& references_before, const ReferencePair& references_after);

// Metrics with a single reference, the mean of both. FLIP and SSIM compare the pictures as displayed in the
// report (display.h).
struct PerceptualErrors {
    double flip = 0.0;  // mean LDR-FLIP
    double ssim = 0.0;
    double specks = 0.0;  // fraction of the pixels
    double energy = 0.0;  // mean luminance over the reference's
};
PerceptualErrors perceptual_errors(const frame::Image& picture, const ReferencePair& references);

}  // namespace tessera::tools::bench
