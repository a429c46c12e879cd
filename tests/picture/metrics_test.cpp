#include "mediator/picture/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mediator/base/error.h"
#include "mediator/base/random.h"
#include "mediator/picture/flip.h"

namespace tessera::picture {
namespace {

frame::Image uniform(float value, std::uint32_t size = 32) {
    frame::Image image(size, size, 3);
    for (float& v : image.values) v = value;
    return image;
}

// A smooth ramp, and the same with noise of the given strength.
frame::Image ramp(float strength) {
    frame::Image image(48, 48, 3);
    CounterRandom random(2);
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        for (float& v : image.pixel(i)) {
            v = 0.2f + 0.6f * static_cast<float>(i % 48) / 48.0f +
                strength * static_cast<float>(random.uniform() - 0.5);
        }
    }
    return image;
}

TEST(Metrics, OfEqualPicturesAreZero) {
    const frame::Image image = ramp(0.1f);
    EXPECT_EQ(mse(image, image), 0.0);
    EXPECT_EQ(relmse(image, image), 0.0);
    EXPECT_EQ(psnr(image, image), std::numeric_limits<double>::infinity());
    EXPECT_NEAR(ssim(image, image), 1.0, 1e-9);
    EXPECT_EQ(ldr_flip_mean(image, image), 0.0);
    EXPECT_EQ(hdr_flip_mean(image, image), 0.0);
}

TEST(Metrics, HaveTheirClosedForms) {
    EXPECT_NEAR(mse(uniform(3.0f), uniform(1.0f)), 4.0, 1e-6);
    // (3 - 1)^2 / (1 + 0.01 * 1^2)
    EXPECT_NEAR(relmse(uniform(3.0f), uniform(1.0f)), 4.0 / 1.01, 1e-5);
    // A black reference: epsilon is 0 and so is the square; the error of a black picture stays 0.
    EXPECT_EQ(relmse(uniform(0.0f), uniform(0.0f)), 0.0);
    EXPECT_GT(ldr_flip_mean(uniform(1.0f), uniform(0.0f)), 0.9)
        << "black and white are as different as can be";
    EXPECT_LE(ldr_flip_mean(uniform(1.0f), uniform(0.0f)), 1.0 + 1e-6);
}

TEST(Metrics, GrowWithTheNoise) {
    const frame::Image reference = ramp(0.0f);
    double last_mse = 0.0, last_flip = 0.0, last_hdr = 0.0, last_ssim = 1.0 + 1e-9;
    for (const float strength : {0.05f, 0.2f, 0.6f}) {
        const frame::Image noisy = ramp(strength);
        EXPECT_GT(mse(noisy, reference), last_mse);
        EXPECT_GT(ldr_flip_mean(noisy, reference), last_flip);
        EXPECT_GT(hdr_flip_mean(noisy, reference), last_hdr);
        EXPECT_LT(ssim(noisy, reference), last_ssim);
        last_mse = mse(noisy, reference);
        last_flip = ldr_flip_mean(noisy, reference);
        last_hdr = hdr_flip_mean(noisy, reference);
        last_ssim = ssim(noisy, reference);
    }
}

TEST(Metrics, RejectPicturesOfOtherSizes) {
    EXPECT_THROW(mse(uniform(1.0f, 8), uniform(1.0f, 9)), Error);
    EXPECT_THROW(relmse(uniform(1.0f, 8), uniform(1.0f, 9)), Error);
    EXPECT_THROW(ssim(uniform(1.0f, 8), uniform(1.0f, 9)), Error);
    EXPECT_THROW(ldr_flip_mean(uniform(1.0f, 8), uniform(1.0f, 9)), Error);
}

}  // namespace
}  // namespace tessera::picture
