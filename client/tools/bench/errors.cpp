#include "client/tools/bench/errors.h"

#include <cmath>
#include <utility>

#include "client/tools/bench/display.h"
#include "mediator/base/error.h"
#include "mediator/picture/color.h"
#include "mediator/picture/flip.h"
#include "mediator/picture/metrics.h"
#include "mediator/picture/same_size.h"

namespace tessera::tools::bench {

namespace {

double mean_luminance(const frame::Image& image) {
    double sum = 0.0;
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const auto p = image.pixel(i);
        sum += picture::luminance(p[0], p[1], p[2]);
    }
    return sum / static_cast<double>(image.pixel_count());
}

// Sum of w (F - R1)(F - R2) and of the squares behind its deviation.
class Sum {
  public:
    void add(double weight, double to_first, double to_second) {
        sum_ += weight * to_first * to_second;
        const double m = 0.5 * (to_first + to_second), d = to_second - to_first;
        pixel_ += weight * m * d;
        ++count_;
    }
    void end_pixel() {
        squares_ += pixel_ * pixel_;
        pixel_ = 0.0;
    }
    Estimate mean() const {
        const double n = static_cast<double>(count_);
        return {sum_ / n, std::sqrt(squares_) / n};
    }

  private:
    double sum_ = 0.0, squares_ = 0.0, pixel_ = 0.0;
    std::size_t count_ = 0;
};

}  // namespace

ReferencePair::ReferencePair(frame::Image first, frame::Image second)
    : first_(std::move(first)), second_(std::move(second)), mean_(first_) {
    picture::require_same_size(first_, second_);
    if (first_.components != 3) throw Error(ErrorCode::InvalidInput, "references need 3 components");
    for (std::size_t i = 0; i < mean_.values.size(); ++i) {
        mean_.values[i] = 0.5f * (first_.values[i] + second_.values[i]);
        if (!std::isfinite(mean_.values[i])) {
            throw Error(ErrorCode::InvalidInput,
                        "a reference has values that are not finite: render it again");
        }
    }
    const double luminance = mean_luminance(mean_);
    epsilon_ = 0.01 * luminance * luminance;
    for (std::size_t i = 0; i < mean_.values.size(); ++i) {
        const double d = static_cast<double>(first_.values[i]) - second_.values[i], r = mean_.values[i];
        noise_mse_ += 0.5 * d * d;
        if (d != 0.0) noise_relmse_ += 0.5 * d * d / (r * r + epsilon_);
    }
    noise_mse_ /= static_cast<double>(mean_.values.size());
    noise_relmse_ /= static_cast<double>(mean_.values.size());
}

SquaredErrors squared_errors(const frame::Image& picture, const ReferencePair& references) {
    picture::require_same_size(picture, references.mean());
    Sum plain, relative;
    for (std::size_t i = 0; i < picture.pixel_count(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t k = 3 * i + c;
            const double f = picture.values[k], r = references.mean().values[k];
            const double first = f - references.first().values[k], second = f - references.second().values[k];
            plain.add(1.0, first, second);
            const double scale = r * r + references.epsilon();
            relative.add(scale > 0.0 ? 1.0 / scale : 0.0, first, second);
        }
        plain.end_pixel();
        relative.end_pixel();
    }
    return {plain.mean(), relative.mean()};
}

Estimate temporal_relmse(const frame::Image& before, const frame::Image& after,
                         const ReferencePair& references_before, const ReferencePair& references_after) {
    picture::require_same_size(before, after);
    picture::require_same_size(before, references_before.mean());
    picture::require_same_size(after, references_after.mean());
    Sum sum;
    for (std::size_t i = 0; i < after.pixel_count(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t k = 3 * i + c;
            const double step = static_cast<double>(after.values[k]) - before.values[k];
            const auto reference_step = [&](const frame::Image& from, const frame::Image& to) {
                return static_cast<double>(to.values[k]) - from.values[k];
            };
            const double r = references_after.mean().values[k];
            const double scale = r * r + references_after.epsilon();
            sum.add(scale > 0.0 ? 1.0 / scale : 0.0,
                    step - reference_step(references_before.first(), references_after.first()),
                    step - reference_step(references_before.second(), references_after.second()));
        }
        sum.end_pixel();
    }
    return sum.mean();
}

SeenErrors seen_errors(const frame::Image& picture, const ReferencePair& references) {
    const Display display(references.mean());
    return {picture::ldr_flip_mean(display.shown(picture), display.shown(references.mean())),
            picture::ssim(picture, references.mean())};
}

}  // namespace tessera::tools::bench
