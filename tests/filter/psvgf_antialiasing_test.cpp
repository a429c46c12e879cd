// Antialiasing of finished pictures by the previous one.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "master/filter/svgf/taa.h"
#include "mediator/base/random.h"

namespace tessera::filter::svgf {
namespace {

struct Screen {
    Screen(std::uint32_t width, std::uint32_t height) : newness(width, height, 1) {
        guides.inverse_depth = Planes(width, height, 1);
        std::ranges::fill(guides.inverse_depth.plane(0), 1.0f);
        motion.identity = true;
        motion.position = Planes(width, height, 2);
        motion.inverse_depth = guides.inverse_depth;
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x) {
                motion.position.row(0, y)[x] = static_cast<float>(x);
                motion.position.row(1, y)[x] = static_cast<float>(y);
            }
        }
    }
    // Pixels were there in the previous picture.
    void move(float dx, float dy) {
        motion.identity = false;
        for (float& x : motion.position.plane(0)) x += dx;
        for (float& y : motion.position.plane(1)) y += dy;
    }
    Planes blend(const Planes& picture, const Planes& before, float ratio) {
        RunContext context{arena, {}};
        Planes out;
        EXPECT_TRUE(antialiasing.run(picture, before, guides, motion, newness, ratio, out, context));
        return out;
    }
    Guides guides;
    Motion motion;
    Planes newness;
    Antialiasing antialiasing;
    tbb::task_arena arena{2};
};

float noise_at(std::uint64_t seed, std::uint32_t x, std::uint32_t y) {
    return static_cast<float>(CounterRandom(seed, std::uint64_t{y} << 32 | x).uniform());
}

TEST(Antialiasing, JitteredEdgesConvergeToTheirCoverage) {  // DT26
    const std::uint32_t width = 64, height = 32;
    Screen screen(width, height);
    const auto edge = [](double x, double y) { return x + 0.37 * y < 36.3 ? 0.2f : 0.8f; };
    Planes shown, exact(width, height, 3);
    std::vector<double> sums(std::size_t{width} * height);
    for (std::uint64_t frame = 0; frame < 64; ++frame) {
        CounterRandom random(frame);
        const double jx = random.uniform(), jy = random.uniform();
        Planes picture(width, height, 3);
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x) {
                for (std::uint32_t c = 0; c < 3; ++c) picture.row(c, y)[x] = edge(x + jx, y + jy);
            }
        }
        shown = frame == 0 ? picture : screen.blend(picture, shown, 0.1f);
    }
    double error = 0.0;
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            double covered = 0.0;
            for (int k = 0; k < 64; ++k) covered += edge(x + (k % 8 + 0.5) / 8, y + (k / 8 + 0.5) / 8) / 64.0;
            const double d = shown.row(0, y)[x] - covered;
            error += d * d;
        }
    }
    EXPECT_LT(std::sqrt(error / (width * height)), 0.02);
}

TEST(Antialiasing, StaysInTheNeighbourhoodRangeWithoutGhosting) {  // DT26
    const std::uint32_t width = 64, height = 32;
    Screen screen(width, height);
    Planes shown;
    for (std::uint32_t frame = 0; frame < 12; ++frame) {
        Planes picture(width, height, 4);
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x) {
                const bool object = x >= 4 * frame && x < 4 * frame + 4;
                for (std::uint32_t c = 0; c < 4; ++c) {
                    picture.row(c, y)[x] = (object ? 1e5f : 0.1f) * (1.0f + 0.1f * c) + noise_at(frame, x, y);
                }
            }
        }
        shown = frame == 0 ? picture : screen.blend(picture, shown, 0.1f);
        for (std::uint32_t y = 1; y + 1 < height; ++y) {
            for (std::uint32_t x = 1; x + 1 < width; ++x) {
                for (std::uint32_t c = 0; c < 4; ++c) {
                    float least = 1e30f, most = -1e30f;
                    for (std::uint32_t ty = y - 1; ty <= y + 1; ++ty) {
                        for (std::uint32_t tx = x - 1; tx <= x + 1; ++tx) {
                            least = std::min(least, picture.row(c, ty)[tx]);
                            most = std::max(most, picture.row(c, ty)[tx]);
                        }
                    }
                    EXPECT_GE(shown.row(c, y)[x], least - 1e-6f * least);
                    EXPECT_LE(shown.row(c, y)[x], most * (1.0f + 1e-6f));
                }
                if (frame >= 1 && x + 2 < 4 * frame) {
                    EXPECT_LT(shown.row(0, y)[x], 2.0f) << frame << " " << x;
                }
            }
        }
    }
}

TEST(Antialiasing, WithNewSamplesAloneThePictureStays) {
    const std::uint32_t width = 16, height = 8;
    Screen screen(width, height);
    std::ranges::fill(screen.newness.values(), 1.0f);
    Planes picture(width, height, 3), before(width, height, 3);
    for (std::size_t i = 0; i < picture.values().size(); ++i) {
        picture.values()[i] = noise_at(3, static_cast<std::uint32_t>(i), 0);
    }
    const Planes out = screen.blend(picture, before, 0.1f);
    for (std::size_t i = 0; i < picture.values().size(); ++i) EXPECT_EQ(out.values()[i], picture.values()[i]);
}

using Scene = std::function<float(float x, float y, std::uint32_t component)>;

Planes photo(std::uint32_t width, std::uint32_t height, std::uint32_t components, float dx, float dy,
             const Scene& scene) {
    Planes picture(width, height, components);
    for (std::uint32_t c = 0; c < components; ++c) {
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x)
                picture.row(c, y)[x] = scene(float(x) + dx, float(y) + dy, c);
        }
    }
    return picture;
}

// Root mean square over pixels that always were inside.
double inner_error(const Planes& a, const Planes& b, std::uint32_t margin) {
    double sum = 0.0, count = 0.0;
    for (std::uint32_t y = margin; y + margin < a.height(); ++y) {
        for (std::uint32_t x = margin; x + margin < a.width(); ++x) {
            sum += std::pow(double(a.row(0, y)[x]) - b.row(0, y)[x], 2.0);
            count += 1.0;
        }
    }
    return std::sqrt(sum / count);
}

// Linear interpolation lowers the contrast of waves of 10 pixels by up to 1 - cos(pi / 10) = 5 % in every frame, and the
// clamp to the neighbourhood does not prevent it.
TEST(Antialiasing, RepeatedInterpolationKeepsDetail) {
    const std::uint32_t width = 96, height = 64;
    const Scene waves = [](float x, float y, std::uint32_t) {
        return 0.5f + 0.2f * std::sin(0.628f * x) + 0.2f * std::sin(0.628f * y);
    };
    Screen screen(width, height);
    screen.move(-0.37f, 0.29f);
    Planes shown = photo(width, height, 3, 0.0f, 0.0f, waves);
    for (int frame = 1; frame <= 32; ++frame) {
        const Planes sharp = photo(width, height, 3, -0.37f * float(frame), 0.29f * float(frame), waves);
        shown = screen.blend(sharp, shown, 0.1f);
        EXPECT_LT(inner_error(shown, sharp, 16), 0.02) << frame;  // of a contrast of 0.2
    }
}

// Lamps are so much brighter than their surroundings that a small fraction of their light hides it.
TEST(Antialiasing, LightOfLampsStaysInTheirPixels) {
    const std::uint32_t width = 96, height = 64;
    const auto lit = [](float x) { return x > 40.0f && x < 52.0f; };
    const Scene lamp = [&](float x, float, std::uint32_t) {
        float covered = 0.0f;
        for (int k = 0; k < 16; ++k) covered += lit(x + (float(k) + 0.5f) / 16.0f) ? 1.0f / 16.0f : 0.0f;
        return 0.1f + 200.0f * covered;
    };
    Screen screen(width, height);
    screen.move(-0.4f, 0.0f);
    Planes shown = photo(width, height, 3, 0.0f, 0.0f, lamp);
    for (int frame = 1; frame <= 16; ++frame) {
        const Planes sharp = photo(width, height, 3, -0.4f * float(frame), 0.0f, lamp);
        shown = screen.blend(sharp, shown, 0.1f);
        for (std::uint32_t x = 16; x < 80; ++x) {
            const float* exact = sharp.row(0, 32) + x;
            const float here = shown.row(0, 32)[x];
            if (exact[0] < 0.11f) {
                EXPECT_LT(here, 1.0f) << frame << " " << x;
            } else if (std::min(exact[-1], exact[1]) > 200.0f) {
                EXPECT_GT(here, 150.0f) << frame << " " << x;
            }
        }
    }
}

// The overshoot of a spline between two bright pixels is above all that the range compression can hold.
TEST(Antialiasing, NarrowLightsStayBright) {
    const std::uint32_t width = 32, height = 16;
    const Scene line = [](float x, float,
                          std::uint32_t) { return x == 15.0f || x == 16.0f ? 1000.0f : 0.1f; },
                anything = [](float x, float y, std::uint32_t) {
                    return std::fmod(x + y, 2.0f) < 1.0f ? 0.1f : 1000.0f;
                };
    Screen screen(width, height);
    screen.move(0.5f, 0.0f);
    const Planes out = screen.blend(photo(width, height, 3, 0.0f, 0.0f, anything),
                                    photo(width, height, 3, 0.0f, 0.0f, line), 0.0f);
    EXPECT_GT(out.row(0, 8)[15], 900.0f);
    EXPECT_LT(out.row(0, 8)[17], 1.0f);
}

TEST(Antialiasing, AlphaIsInterpolatedWithTheColors) {
    const std::uint32_t width = 32, height = 32;
    const Scene slope = [](float x, float y, std::uint32_t c) {
        return c < 3 ? 0.5f : 0.01f * x + 0.015f * y;
    };
    Screen screen(width, height);
    screen.move(0.3f, -0.6f);
    const Planes here = photo(width, height, 4, 0.3f, -0.6f, slope),
                 out = screen.blend(here, photo(width, height, 4, 0.0f, 0.0f, slope), 0.0f);
    for (std::uint32_t y = 2; y + 2 < height; ++y) {
        for (std::uint32_t x = 2; x + 2 < width; ++x) EXPECT_NEAR(out.row(3, y)[x], here.row(3, y)[x], 1e-6f);
    }
}

}  // namespace
}  // namespace tessera::filter::svgf
