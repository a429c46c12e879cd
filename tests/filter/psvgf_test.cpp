// Progressive SVGF on static pictures (Dundr 2, tests DT of the notes).
#include <gtest/gtest.h>

#include <cmath>

#include "master/filter/catalog.h"
#include "mediator/base/random.h"
#include "mediator/filter/choice.h"
#include "tests/filter/synthetic.h"

namespace tessera::filter {
namespace {

constexpr std::uint32_t PsvgfWidth = 96, PsvgfHeight = 54;

Inputs psvgf_shadows(std::uint64_t n, std::uint64_t seed = 1) {
    Inputs inputs = synthetic_inputs(PsvgfWidth, PsvgfHeight, n, [seed](auto x, auto y, auto i) {
        return shadowed_texture(PsvgfWidth, PsvgfHeight, x, y, i, seed);
    });
    inputs.path_class = view::PathClass::Diffuse;
    return inputs;
}

// L37's measure: squared error by the square of the truth.
double psvgf_error(const Planes& picture, const Planes& truth) {
    double sum = 0.0;
    for (std::uint32_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < truth.pixel_count(); ++i) {
            const double t = truth.plane(c)[i], d = picture.plane(c)[i] - t;
            sum += d * d / (t * t + 1e-2);
        }
    }
    return sum / static_cast<double>(3 * truth.pixel_count());
}

TEST(Psvgf, IsConsistent) {
    const Planes truth = shadowed_texture_truth(PsvgfWidth, PsvgfHeight);
    for (const std::uint64_t n : {4u, 8u, 16u, 32u, 64u, 128u, 256u, 512u, 1024u}) {
        const Inputs inputs = psvgf_shadows(n);
        const double unfiltered = psvgf_error(run_filter("none", inputs).picture, truth);
        for (const char* how : {"psvgf", "psvgf:mode=svgf", "psvgf:mode=dundr", "psvgf:sigma_l=100"}) {
            EXPECT_LE(psvgf_error(run_filter(how, inputs).picture, truth), 1.05 * unfiltered)
                << how << " " << n;
        }
        const double filtered = psvgf_error(run_filter("psvgf", inputs).picture, truth);
        EXPECT_LE(filtered, (n <= 16 ? 0.16 : 0.25) * unfiltered) << n;
    }
    // Without the convergence blend, a filter that is too strong is not.
    const Inputs inputs = psvgf_shadows(1024);
    EXPECT_GT(psvgf_error(run_filter("psvgf:sigma_l=100,blend=off", inputs).picture, truth),
              psvgf_error(run_filter("none", inputs).picture, truth));
}

TEST(Psvgf, ErrorFallsWithEverySample) {  // DT20
    const Planes truth = shadowed_texture_truth(PsvgfWidth, PsvgfHeight);
    double last = 1e30;
    for (std::uint64_t n = 1; n <= 256; n *= 2) {
        const Inputs inputs = psvgf_shadows(n);
        const double error = psvgf_error(run_filter("psvgf", inputs).picture, truth);
        // A single sample says nothing of its noise, so that its picture is filtered as if no light were rare.
        if (n > 2) {
            EXPECT_LE(error, 1.05 * last) << n;
        }
        EXPECT_LT(error, psvgf_error(run_filter("none", inputs).picture, truth)) << n;
        last = error;
    }
}

TEST(Psvgf, TheRestIsUnfilteredOrFiltered) {
    Inputs inputs = synthetic_inputs(PsvgfWidth, PsvgfHeight, 8, [](auto x, auto y, auto i) {
        SyntheticSample s = shadowed_texture(PsvgfWidth, PsvgfHeight, x, y, i, 1);
        const SyntheticSample other = shadowed_texture(PsvgfWidth, PsvgfHeight, x, y, i, 2);
        s.low = other.irradiance;
        return s;
    });
    inputs.path_class = view::PathClass::Diffuse;
    Inputs without = inputs;
    for (std::uint32_t c = 0; c < 3; ++c) {
        auto& low = without.means[std::size_t(frame::Channel::LowVariance)];
        std::ranges::fill(low.plane(c), 0.0f);
    }
    const Planes all = run_filter("psvgf:blend=off", inputs).picture,
                 diffuse = run_filter("psvgf:blend=off", without).picture;
    const Planes& rest = inputs.mean(frame::Channel::LowVariance);
    for (std::size_t i = 0; i < rest.values().size(); ++i) {
        EXPECT_NEAR(all.values()[i] - diffuse.values()[i], rest.values()[i], 2e-6);
    }
    Planes truth = shadowed_texture_truth(PsvgfWidth, PsvgfHeight);
    for (std::uint32_t y = 0; y < PsvgfHeight; ++y) {
        for (std::uint32_t x = 0; x < PsvgfWidth; ++x) {
            const float light =
                truth.row(0, y)[x] / inputs.mean(frame::Channel::Albedo).row(0, y)[x];  // of the rest as well
            for (std::uint32_t c = 0; c < 3; ++c) truth.row(c, y)[x] += light;
        }
    }
    EXPECT_LT(psvgf_error(run_filter("psvgf:rest=filtered", inputs).picture, truth),
              0.3 * psvgf_error(all, truth));
}

// Diffuse light, and another kind of light whose noise is far larger than what the filter blurs.
Inputs with_noisy_rest(bool has_diffuse) {
    Inputs inputs = synthetic_inputs(PsvgfWidth, PsvgfHeight, 256, [=](auto x, auto y, auto i) {
        SyntheticSample s = shadowed_texture(PsvgfWidth, PsvgfHeight, x, y, i, 1);
        const std::uint64_t key = (std::uint64_t{y} << 16 | x) << 16 | i;
        const bool is_find = CounterRandom(3, key).uniform() < 1.0 / 64.0;
        s.low = is_find ? std::array<float, 3>{64.0f, 64.0f, 64.0f} : std::array<float, 3>{};
        if (!has_diffuse) s.high = s.irradiance = {};
        return s;
    });
    inputs.path_class = view::PathClass::Diffuse;
    return inputs;
}

// The blend corrects what is wrong with the diffuse part, although the rest has more noise. (Both parts together were left as
// wrong as without a blend.)
TEST(Psvgf, FilteredPartsDoNotHideEachOthersErrors) {
    const Inputs both = with_noisy_rest(true), rest_alone = with_noisy_rest(false);
    const Planes truth = shadowed_texture_truth(PsvgfWidth, PsvgfHeight);
    const auto error_of_diffuse = [&](const std::string& how) {
        Planes diffuse = run_filter(how, both).picture;
        const Planes rest = run_filter(how, rest_alone).picture;
        for (std::size_t i = 0; i < rest.values().size(); ++i) diffuse.values()[i] -= rest.values()[i];
        return psvgf_error(diffuse, truth);
    };
    EXPECT_LT(error_of_diffuse("psvgf:rest=filtered,sigma_l=100"),
              0.5 * error_of_diffuse("psvgf:rest=filtered,sigma_l=100,blend=off"));
}

TEST(Psvgf, OtherPathClassesUseTheIrradiance) {
    Inputs inputs = psvgf_shadows(8);
    const Planes diffuse = run_filter("psvgf", inputs).picture;
    inputs.path_class = view::PathClass::Indirect;
    for (const auto channel : {frame::Channel::HighVariance, frame::Channel::LowVariance}) {
        std::ranges::fill(inputs.means[std::size_t(channel)].values(), 0.0f);
    }
    const Planes indirect = run_filter("psvgf", inputs).picture;
    for (std::size_t i = 0; i < diffuse.values().size(); ++i) {
        EXPECT_NEAR(indirect.values()[i], diffuse.values()[i], 1e-5);
    }
}

TEST(Psvgf, PartlyCoveredPixelsKeepTheirLight) {
    // A white surface under constant light covers half of the pixels of a column; the background is black.
    const auto sampler = [](std::uint32_t x, std::uint32_t, std::uint64_t i) {
        SyntheticSample s;
        const bool covered = x < 48 || (x == 48 && i % 2 == 0);
        s.object = covered ? 1 : 0;
        s.depth = covered ? 1.0f : std::numeric_limits<float>::infinity();
        s.albedo.fill(covered ? 1.0f : 0.0f);
        s.normal = covered ? std::array{0.0f, 0.0f, 1.0f} : std::array{0.0f, 0.0f, 0.0f};
        s.irradiance.fill(covered ? 3.0f : 0.0f);
        s.high.fill(covered ? 3.0f : 0.0f);
        s.alpha = covered ? 1.0f : 0.0f;
        return s;
    };
    Inputs inputs = synthetic_inputs(PsvgfWidth, PsvgfHeight, 8, sampler);
    inputs.path_class = view::PathClass::Diffuse;
    const Planes picture = run_filter("psvgf", inputs).picture;
    ASSERT_EQ(picture.components(), 4u);
    EXPECT_NEAR(picture.row(0, 20)[47], 3.0f, 1e-4);
    EXPECT_NEAR(picture.row(0, 20)[48], 1.5f, 1e-4);
    EXPECT_EQ(picture.row(0, 20)[49], 0.0f);
    EXPECT_EQ(picture.row(3, 20)[48], 0.5f);
}

TEST(Psvgf, ConstantLightStays) {  // DT13
    for (const std::uint64_t n : {1u, 2u, 5u}) {
        Inputs inputs = synthetic_inputs(PsvgfWidth, PsvgfHeight, n, [](auto x, auto y, auto i) {
            SyntheticSample s = shadowed_texture(PsvgfWidth, PsvgfHeight, x, y, i);
            s.irradiance.fill(0.7f);
            for (int c = 0; c < 3; ++c) s.high[c] = s.albedo[c] * 0.7f;
            s.object = x / 7;
            s.depth = 1.0f + 0.01f * static_cast<float>(y % 11);
            return s;
        });
        inputs.path_class = view::PathClass::Diffuse;
        const Planes picture = run_filter("psvgf", inputs).picture;
        for (std::uint32_t c = 0; c < 3; ++c) {
            for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
                EXPECT_NEAR(picture.plane(c)[i], inputs.mean(frame::Channel::Radiance).plane(c)[i], 1e-6);
            }
        }
    }
}

// The distance between 10 and 90 % of the step of light across a vertical edge at the centre.
double edge_width(const Planes& picture) {
    std::vector<double> profile(PsvgfWidth);
    for (std::uint32_t y = 0; y < PsvgfHeight; ++y) {
        for (std::uint32_t x = 0; x < PsvgfWidth; ++x) profile[x] += picture.row(0, y)[x] / PsvgfHeight;
    }
    const double dark = profile.front(), bright = profile.back();
    const auto crossing = [&](double fraction) {
        const double level = dark + fraction * (bright - dark);
        for (std::uint32_t x = 1; x < PsvgfWidth; ++x) {
            if (profile[x] >= level) {
                return x - 1 + (level - profile[x - 1]) / std::max(profile[x] - profile[x - 1], 1e-9);
            }
        }
        return double(PsvgfWidth);
    };
    return crossing(0.9) - crossing(0.1);
}

TEST(Psvgf, HardShadowsStayHard) {  // DT15
    Inputs inputs = synthetic_inputs(PsvgfWidth, PsvgfHeight, 16, [](auto x, auto y, auto i) {
        SyntheticSample s = shadowed_texture(PsvgfWidth, PsvgfHeight, x, y, i);
        CounterRandom random(5, (std::uint64_t{y} << 32 | x) ^ mix(i));
        const float light = random.uniform() < (x < PsvgfWidth / 2 ? 0.15 : 0.9) ? 1.0f : 0.0f;
        s.irradiance.fill(light);
        s.albedo.fill(1.0f);
        s.high.fill(light);
        s.normal = {0.0f, 0.0f, 1.0f};
        return s;
    });
    inputs.path_class = view::PathClass::Diffuse;
    EXPECT_LT(edge_width(run_filter("psvgf", inputs).picture), 2.8);  // of a step: 0.8
    EXPECT_LT(edge_width(run_filter("psvgf:blend=off", inputs).picture), 2.8);
    EXPECT_GT(edge_width(run_filter("psvgf:blend=off,sigma_l=1000", inputs).picture), 20.0);
}

TEST(Psvgf, SteepSidesAreFilteredOnceDepthIsIgnored) {  // DT27
    const auto residual = [](const std::string& choice) {
        Inputs inputs = synthetic_inputs(PsvgfWidth, PsvgfHeight, 4, [](auto x, auto y, auto i) {
            SyntheticSample s = shadowed_texture(PsvgfWidth, PsvgfHeight, x, y, i);
            // Strips of a few pixels, each very steep: slopes differ from pixel to pixel.
            CounterRandom jitter(3, std::uint64_t{y} << 32 | x);
            s.depth = static_cast<float>(1.0 + 2.0 * (x % 4) + 1.5 * jitter.uniform());
            CounterRandom random(5, (std::uint64_t{y} << 32 | x) ^ mix(i));
            const float light = random.uniform() < 0.5 ? 1.0f : 0.0f;
            s.irradiance.fill(light);
            s.albedo.fill(1.0f);
            s.high.fill(light);
            s.normal = {0.0f, 0.0f, 1.0f};
            return s;
        });
        inputs.path_class = view::PathClass::Diffuse;
        double sum = 0.0;
        const Planes picture = run_filter(choice, inputs).picture;
        for (const float v : picture.plane(0)) sum += (v - 0.5) * (v - 0.5);
        return sum;
    };
    EXPECT_LT(residual("psvgf:blend=off"), 0.8 * residual("psvgf:blend=off,steep=1e6"));
}

TEST(Psvgf, HolesAreFilled) {
    Inputs inputs = psvgf_shadows(4);
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
        if (mix(i) % 10 != 0) continue;
        inputs.counts.plane(0)[i] = 0.0f;
        inputs.object_ids[i] = 0;
        for (std::size_t channel = 0; channel < frame::ChannelCount; ++channel) {
            for (std::uint32_t c = 0; c < inputs.means[channel].components(); ++c) {
                inputs.means[channel].plane(c)[i] = 0.0f;
            }
        }
        inputs.means[std::size_t(frame::Channel::Depth)].plane(0)[i] = std::numeric_limits<float>::infinity();
    }
    const Planes truth = shadowed_texture_truth(PsvgfWidth, PsvgfHeight);
    EXPECT_LT(psvgf_error(run_filter("psvgf", inputs).picture, truth),
              0.2 * psvgf_error(run_filter("none", inputs).picture, truth));
}

TEST(Psvgf, WithoutItsChannelsItWarns) {
    const Inputs inputs = synthetic_inputs(
        PsvgfWidth, PsvgfHeight, 2,
        [](auto x, auto y, auto i) { return shadowed_texture(PsvgfWidth, PsvgfHeight, x, y, i); },
        {frame::Channel::Radiance});
    const FilterEntry& entry = *parse_choice("psvgf", catalog()).value().entry;
    tbb::task_arena arena(2);
    Output out;
    const Report report =
        entry.make(PsvgfWidth, PsvgfHeight)->run(inputs, default_values(entry.description), out, {arena, {}});
    ASSERT_EQ(report.notes.size(), 1u);
    EXPECT_NE(report.notes[0].find("unfiltered"), std::string::npos);
    EXPECT_TRUE(std::ranges::equal(out.picture.values(), inputs.mean(frame::Channel::Radiance).values()));
}

TEST(Psvgf, AnyNumberOfThreadsGivesTheSameBits) {  // DT33
    const Inputs inputs = psvgf_shadows(3);
    const Choice choice = parse_choice("psvgf:rest=filtered", catalog()).value();
    std::vector<Planes> pictures;
    for (const int threads : {1, 2, 5}) {
        tbb::task_arena arena(threads);
        Output out;
        choice.entry->make(PsvgfWidth, PsvgfHeight)->run(inputs, choice.values, out, {arena, {}});
        pictures.push_back(out.picture);
    }
    EXPECT_TRUE(std::ranges::equal(pictures[0].values(), pictures[1].values()));
    EXPECT_TRUE(std::ranges::equal(pictures[0].values(), pictures[2].values()));
}

}  // namespace
}  // namespace tessera::filter
