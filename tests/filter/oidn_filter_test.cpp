// The filter around Open Image Denoise, with the known operation of a stand-in (tests/oidn).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "master/filter/catalog.h"
#include "mediator/base/random.h"
#include "mediator/filter/choice.h"
#include "tests/filter/synthetic.h"
#include "tests/oidn/stand_in.h"
#include "tests/support/environment.h"

namespace tessera::filter {
namespace {

using frame::Channel;
using test::EnvironmentVariable;

constexpr std::uint32_t CheckerWidth = 33, CheckerHeight = 21;

// Noise on a checker of albedo with a tilted half, in front of a background on the right. Between them, pixels that are
// partly covered by something with the features of the background.
SyntheticSample noisy_checker(std::uint32_t x, std::uint32_t y, std::uint64_t sample) {
    CounterRandom random(5, mix((std::uint64_t{y} << 32 | x) ^ mix(sample)));
    SyntheticSample s;
    const bool covered = x < 22 || (x < 24 && random.uniform() < 0.5);
    const float shade = (x / 4 + y / 4) % 2 == 0 ? 0.3f : 0.8f;
    s.alpha = covered ? 1.0f : 0.0f;
    s.albedo = x < 22 ? std::array{shade, 0.5f * shade, 0.4f} : std::array{0.0f, 0.0f, 0.0f};
    s.normal = x < 22 ? (y < 10 ? std::array{0.0f, 0.0f, 1.0f} : std::array{0.6f, 0.0f, 0.8f})
                      : std::array{0.0f, 0.0f, 0.0f};
    for (int c = 0; c < 3; ++c)
        s.high[c] = covered ? (0.1f + s.albedo[c]) * static_cast<float>(2.0 * random.uniform()) : 0.0f;
    return s;
}

Inputs checker_inputs(std::uint64_t n = 4, std::uint32_t width = CheckerWidth,
                      std::uint32_t height = CheckerHeight) {
    return synthetic_inputs(width, height, n, noisy_checker);
}

bool looks_alike(const Inputs& inputs, std::size_t a, std::size_t b) {
    for (const Channel channel : {Channel::Albedo, Channel::Normal}) {
        for (std::uint32_t c = 0; c < 3; ++c) {
            const auto plane = inputs.mean(channel).plane(c);
            if (std::abs(plane[a] - plane[b]) > test::StandInRange) return false;
        }
    }
    return true;
}

// The mean of the pixels like this one, with the window that the operation has.
double known_mean(const Inputs& inputs, std::uint32_t component, std::uint32_t x, std::uint32_t y) {
    const auto radius = static_cast<std::uint32_t>(test::StandInRadius);
    double sum = 0.0, count = 0.0;
    for (std::uint32_t j = 0; j < inputs.height; ++j) {
        for (std::uint32_t i = 0; i < inputs.width; ++i) {
            if (i + radius < x || i > x + radius || j + radius < y || j > y + radius) continue;
            if (!looks_alike(inputs, x + y * inputs.width, i + j * inputs.width)) continue;
            sum += inputs.color(component)[i + j * inputs.width];
            count += 1.0;
        }
    }
    return sum / count;
}

double worst_of_known(const Inputs& inputs, const Planes& picture) {
    double worst = 0.0;
    for (std::uint32_t c = 0; c < picture.components(); ++c) {
        for (std::uint32_t y = 0; y < inputs.height; ++y) {
            for (std::uint32_t x = 0; x < inputs.width; ++x)
                worst = std::max(worst, std::abs(picture.row(c, y)[x] - known_mean(inputs, c, x, y)));
        }
    }
    return worst;
}

// One filter for several runs.
struct OidnRuns {
    OidnRuns()
        : choice(parse_choice("oidn:blend=off", catalog()).value()), filter(choice.entry->make(0, 0)) {}
    Report run(const Inputs& inputs, std::stop_token stop = {}) {
        return filter->run(inputs, choice.values, out, {arena, stop});
    }

    Choice choice;
    std::unique_ptr<Filter> filter;
    tbb::task_arena arena{2};
    Output out;
};

TEST(OidnFilter, GivesTheLibraryColorAlbedoAndNormals) {
    const Inputs inputs = checker_inputs();
    const Output out = run_filter("oidn:blend=off", inputs);
    ASSERT_EQ(out.picture.components(), 4u);
    EXPECT_LE(worst_of_known(inputs, out.picture), 1e-6);
    double changed = 0.0;
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i)
        changed = std::max<double>(changed, std::abs(out.picture.plane(0)[i] - inputs.color(0)[i]));
    EXPECT_GT(changed, 0.1) << "the operation leaves the picture as it is";
}

TEST(OidnFilter, FollowsTheSizeOfTheInputs) {
    OidnRuns runs;
    for (const auto& [width, height] :
         {std::pair{CheckerWidth, CheckerHeight}, {12u, 17u}, {CheckerWidth, CheckerHeight}}) {
        const Inputs inputs = checker_inputs(4, width, height);
        runs.run(inputs);
        EXPECT_LE(worst_of_known(inputs, runs.out.picture), 1e-6) << width << " x " << height;
    }
}

// A network does not quite keep what is constant.
TEST(OidnFilter, AlphaIsExactWhereItDoesNotVary) {
    const EnvironmentVariable dim("TESSERA_OIDN_FAILS", "dim");
    const Inputs inputs = checker_inputs();
    const Output out = run_filter("oidn:blend=off", inputs);
    bool filtered = false;
    for (std::uint32_t y = 0; y < CheckerHeight; ++y) {
        for (std::uint32_t x = 0; x < CheckerWidth; ++x) {
            const float alpha = out.picture.row(3, y)[x];
            if (x < 20 || x > 25) {
                ASSERT_EQ(alpha, x < 20 ? 1.0f : 0.0f) << x << " " << y;
            } else {
                ASSERT_LE(alpha, 0.99f) << x << " " << y;
            }
            filtered = filtered || (alpha > 0.0f && alpha < 0.99f);
        }
    }
    EXPECT_TRUE(filtered) << "covered edges have no noise";
}

TEST(OidnFilter, OpaquePicturesStayOpaque) {
    const Inputs opaque = synthetic_inputs(
        CheckerWidth, CheckerHeight, 4, [](auto x, auto y, auto i) { return noisy_checker(x % 20, y, i); });
    const Output out = run_filter("oidn:blend=off", opaque);
    EXPECT_EQ(std::ranges::count(out.picture.plane(3), 1.0f), std::ptrdiff_t{CheckerWidth} * CheckerHeight);
}

TEST(OidnFilter, BlendsBackToTheSamples) {
    const Inputs inputs = checker_inputs(256);
    const Output plain = run_filter("oidn:blend=off", inputs), blended = run_filter("oidn", inputs, true);
    ASSERT_EQ(blended.maps.size(), 1u);
    EXPECT_EQ(blended.maps[0].name, "blend");
    double to_plain = 0.0, to_samples = 0.0;
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
        to_plain += std::abs(blended.picture.plane(0)[i] - plain.picture.plane(0)[i]);
        to_samples += std::abs(blended.picture.plane(0)[i] - inputs.color(0)[i]);
    }
    EXPECT_GT(to_plain, 0.0);
    EXPECT_GT(to_samples, 0.0);
}

TEST(OidnFilter, ValuesThatAreNotFiniteAreReplaced) {
    const EnvironmentVariable nan("TESSERA_OIDN_FAILS", "nan");
    const Inputs inputs = checker_inputs();
    const Output out = run_filter("oidn:blend=off", inputs);
    EXPECT_EQ(out.picture.plane(0)[0], inputs.color(0)[0]);
    EXPECT_NE(out.picture.plane(1)[0], inputs.color(1)[0]);
}

TEST(OidnFilter, ErrorsOfTheLibraryAreErrorsOfThePicture) {
    const Inputs inputs = checker_inputs();
    const auto message = [&](const std::string& what) {
        const EnvironmentVariable fails("TESSERA_OIDN_FAILS", what);
        OidnRuns runs;
        try {
            runs.run(inputs);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    EXPECT_EQ(message("commit device"),
              "Open Image Denoise cannot start its device: the device is lost (error 1)");
    EXPECT_EQ(message("filter"), "Open Image Denoise cannot create its filter: out of memory (error 4)");
    EXPECT_EQ(message("commit filter"),
              "Open Image Denoise cannot prepare its filter: out of memory (error 4)");
    EXPECT_EQ(message("execute"),
              "Open Image Denoise cannot filter the picture: the network is lost (error 1)");
}

TEST(OidnFilter, GoesOnAfterAnError) {
    const Inputs inputs = checker_inputs();
    for (const char* what : {"commit device", "filter", "commit filter", "execute"}) {
        OidnRuns runs;
        {
            const EnvironmentVariable fails("TESSERA_OIDN_FAILS", what);
            EXPECT_THROW(runs.run(inputs), Error) << what;
        }
        runs.run(inputs);
        EXPECT_LE(worst_of_known(inputs, runs.out.picture), 1e-6) << "after " << what;
    }
}

TEST(OidnFilter, AStopCancelsTheLibrary) {
    const Inputs inputs = checker_inputs();
    OidnRuns runs;
    runs.run(inputs);
    std::stop_source stop;
    stop.request_stop();
    EXPECT_TRUE(runs.run(inputs, stop.get_token()).stopped);
    EXPECT_FALSE(runs.run(inputs).stopped);
    EXPECT_LE(worst_of_known(inputs, runs.out.picture), 1e-6);
}

TEST(OidnFilter, IsNotForReproducibleFrames) {
    const Choice choice = parse_choice("oidn", catalog()).value();
    EXPECT_NE(why_not_reproducible(*choice.entry).find("'oidn'"), std::string::npos);
    for (const FilterEntry& entry : catalog()) {
        if (entry.description.name != "oidn") {
            EXPECT_EQ(why_not_reproducible(entry), "");
        }
    }
}

}  // namespace
}  // namespace tessera::filter
