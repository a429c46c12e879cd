#include "tests/bench/filters/errors.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/picture/color.h"
#include "mediator/picture/flip.h"
#include "mediator/picture/metrics.h"
#include "mediator/picture/same_size.h"
#include "tests/bench/filters/display.h"
#include "tests/bench/filters/looks.h"

namespace tessera::tools::bench {

namespace {

// Per pixel the sums over components of w (F - R1)(F - R2), of the terms of its variance, and of the plain
// squared error.
class Sum {
  public:
    explicit Sum(std::size_t pixels) { pixels_.reserve(pixels); }
    void add(double weight, double to_first, double to_second) {
        const double m = 0.5 * (to_first + to_second), d = to_second - to_first;
        pixel_.product += weight * to_first * to_second;
        pixel_.deviation += weight * m * d;
        pixel_.size += weight * m * m;
    }
    void end_pixel() { pixels_.push_back(std::exchange(pixel_, {})); }

    RelativeErrors means() {
        const Estimate all = mean(pixels_);
        const auto left_out = static_cast<std::size_t>(std::ceil(TrimmedFraction * double(pixels_.size())));
        const std::size_t kept = pixels_.size() - std::min(left_out, pixels_.size() - 1);
        std::nth_element(pixels_.begin(), pixels_.begin() + static_cast<std::ptrdiff_t>(kept - 1),
                         pixels_.end(), [](const Pixel& a, const Pixel& b) { return a.size < b.size; });
        return {all, mean(std::span(pixels_).first(kept))};
    }

  private:
    struct Pixel {
        double product = 0.0, deviation = 0.0, size = 0.0;
    };
    static Estimate mean(std::span<const Pixel> pixels) {
        double sum = 0.0, squares = 0.0;
        for (const Pixel& pixel : pixels) {
            sum += pixel.product;
            squares += pixel.deviation * pixel.deviation;
        }
        const double n = 3.0 * double(pixels.size());
        return {sum / n, std::sqrt(squares) / n};
    }

    std::vector<Pixel> pixels_;
    Pixel pixel_;
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
    Sum plain(picture.pixel_count()), relative(picture.pixel_count());
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
    return {plain.means().all, relative.means()};
}

RelativeErrors temporal_relmse(const frame::Image& before, const frame::Image& after,
                               const ReferencePair& references_before,
                               const ReferencePair& references_after) {
    picture::require_same_size(before, after);
    picture::require_same_size(before, references_before.mean());
    picture::require_same_size(after, references_after.mean());
    Sum sum(after.pixel_count());
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
    return sum.means();
}

PerceptualErrors perceptual_errors(const frame::Image& picture, const ReferencePair& references) {
    const Display display(references.mean());
    const double light = mean_luminance(references.mean());
    return {.flip = picture::ldr_flip_mean(display.shown(picture), display.shown(references.mean())),
            .ssim = picture::ssim(picture, references.mean()),
            .specks = speck_fraction(picture, references.mean()),
            .energy = light > 0.0 ? mean_luminance(picture) / light : 1.0};
}

}  // namespace tessera::tools::bench
