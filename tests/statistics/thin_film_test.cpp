// Colours of thin films against Airy's sum over all wavelengths, against surfaces without a film, and for
// reciprocity.
#include "mediator/shading/thin_film.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "mediator/shading/perfect_specular.h"
#include "tests/statistics/lobes.h"
#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

using shading::film_light;
using shading::FilmLight;
using shading::make_film;
using shading::thin_film_reflectance;
using shading::thin_film_reflectances;
using shading::ThinFilm;

// CIE 1931, 2 degrees: 380 to 770 nm by 10.
constexpr std::array<glm::dvec3, 40> ColorMatching{
    {{.0014, .0000, .0065},  {.0042, .0001, .0201},  {.0143, .0004, .0679},  {.0435, .0012, .2074},
     {.1344, .0040, .6456},  {.2839, .0116, 1.3856}, {.3483, .0230, 1.7471}, {.3362, .0380, 1.7721},
     {.2908, .0600, 1.6692}, {.1954, .0910, 1.2876}, {.0956, .1390, .8130},  {.0320, .2080, .4652},
     {.0049, .3230, .2720},  {.0093, .5030, .1582},  {.0633, .7100, .0782},  {.1655, .8620, .0422},
     {.2904, .9540, .0203},  {.4334, .9950, .0087},  {.5945, .9950, .0039},  {.7621, .9520, .0021},
     {.9163, .8700, .0017},  {1.0263, .7570, .0011}, {1.0622, .6310, .0008}, {1.0026, .5030, .0003},
     {.8544, .3810, .0002},  {.6424, .2650, .0},     {.4479, .1750, .0},     {.2835, .1070, .0},
     {.1649, .0610, .0},     {.0874, .0320, .0},     {.0468, .0170, .0},     {.0227, .0082, .0},
     {.0114, .0041, .0},     {.0058, .0021, .0},     {.0029, .0010, .0},     {.0014, .0005, .0},
     {.0007, .0003, .0},     {.0003, .0001, .0},     {.0002, .0001, .0},     {.0001, .0000, .0}}};

// Of a spectrum that is 1 everywhere: white.
template <class Spectrum>
glm::dvec3 color_of(const Spectrum& spectrum) {
    glm::dvec3 sum(0.0), white(0.0);
    for (double wavelength = 380.0; wavelength < 770.0; wavelength += 0.5) {
        const double place = (wavelength - 380.0) / 10.0;
        const auto i = static_cast<std::size_t>(place);
        const glm::dvec3 xyz = glm::mix(ColorMatching[i], ColorMatching[i + 1], place - double(i));
        white += xyz;
        sum += xyz * spectrum(wavelength);
    }
    const glm::dmat3 rec709({3.2404542, -0.9692660, 0.0556434}, {-1.5371385, 1.8760108, -0.2040259},
                            {-0.4985314, 0.0415560, 1.0572252});
    return rec709 * (sum / white) / (rec709 * glm::dvec3(1.0));
}

// The error of the Gaussian fits to the colour matching curves, per colour channel.
glm::dvec3 error_of_gaussians(const FilmLight& light, double path_length) {
    const auto phase = [&](double wavelength) { return 2.0 * std::numbers::pi * path_length / wavelength; };
    const glm::dvec3 curve = color_of([&](double wavelength) { return std::cos(phase(wavelength)); });
    return glm::abs(curve - glm::dvec3(light.once));
}

TEST(ThinFilm, SensitivitiesAreThoseOfTheColourMatchingCurves) {
    glm::dvec3 worst(0.0), squares(0.0);
    int count = 0;
    for (double path_length = 0.0; path_length <= 6000.0; path_length += 10.0) {
        const ThinFilm film = make_film(1.0f, 1.0f, 1.5f, float(path_length / 3.0));
        const FilmLight light = film_light(film, 1.0f);
        const glm::dvec3 error = error_of_gaussians(light, path_length);
        worst = glm::max(worst, error);
        squares += error * error;
        ++count;
        // Twice is once of a film of twice the thickness.
        const FilmLight doubled = film_light(make_film(1.0f, 1.0f, 1.5f, float(path_length / 1.5)), 1.0f);
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(light.twice[i], doubled.once[i], 2e-5f) << path_length;
    }
    const glm::dvec3 root_mean_square = glm::sqrt(squares / double(count));
    std::printf("worst %.4f %.4f %.4f, rms %.4f %.4f %.4f\n", worst.x, worst.y, worst.z, root_mean_square.x,
                root_mean_square.y, root_mean_square.z);
    // Of cosines: the fits of Belcour and Barla are as good as this.
    EXPECT_LT(shading::largest(glm::vec3(worst)), 0.17f);
    EXPECT_LT(shading::largest(glm::vec3(root_mean_square)), 0.085f);
    const glm::vec3 white = film_light(make_film(1.0f, 1.0f, 1.5f, 0.0f), 1.0f).once;
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(white[i], 1.0f, 1e-6f);
}

// At an angle the optical path is shorter, by the cosine inside: n d cos = d sqrt(n^2 - sin^2).
TEST(ThinFilm, OpticalPathIsShorterAtAnAngle) {
    for (const double cosine : {0.9, 0.5, 0.1}) {
        const double inside = std::sqrt(1.0 - (1.0 - cosine * cosine) / (1.5 * 1.5));
        const FilmLight aslant = film_light(make_film(1.0f, 1.0f, 1.5f, 400.0f), float(cosine));
        const FilmLight straight = film_light(make_film(1.0f, 1.0f, 1.5f, float(400.0 * inside)), 1.0f);
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(aslant.once[i], straight.once[i], 1e-5f) << cosine;
    }
}

// Half of a surface under a film is half of one and half of the other, whatever it is made of.
TEST(ThinFilm, IsBlendedByItsFactor) {
    const auto fresnel = [](float strength, float metallic) {
        shading::MaterialSample material_sample =
            shading::default_material_sample(glm::vec3(0.8f, 0.5f, 0.2f), metallic, 0.5f, 0.0f, 1.5f, 1.5f);
        material_sample.lobes = shading::FeatureIridescence;
        material_sample.film = make_film(strength, 1.0f, 1.8f, 330.0f);
        const shading::Bsdf bsdf =
            test::make_bsdf(material_sample, make_mixture(material_sample), {0.6f, 0.0f, 0.8f});
        return specular_fresnel(bsdf, 0.7f);
    };
    for (const float metallic : {0.0f, 0.4f, 1.0f}) {
        const glm::vec3 none = fresnel(0.0f, metallic), all = fresnel(1.0f, metallic);
        for (int i = 0; i < 3; ++i) {
            EXPECT_NEAR(fresnel(0.3f, metallic)[i], 0.7f * none[i] + 0.3f * all[i], 1e-6f) << metallic;
        }
        EXPECT_GT(shading::largest(glm::abs(all - none)), 0.01f) << metallic;
    }
}

// Light straight down, where Fresnel's and Schlick's reflectances are exact: the sum over all orders, by
// complex amplitudes, for every wavelength.
TEST(ThinFilm, MatchesAirysSumOverTheSpectrum) {
    double largest_error = 0.0;
    for (const double n : {1.1, 1.33, 1.5, 1.8, 2.4}) {
        for (const double base : {1.0, 1.2, 1.5, 2.0, 4.0, 12.0}) {
            for (const double thickness : {20.0, 80.0, 139.0, 250.0, 400.0, 700.0, 1500.0}) {
                const ThinFilm film = make_film(1.0f, 1.0f, float(n), float(thickness));
                const double r12 = (1.0 - n) / (1.0 + n), r23 = (n - base) / (n + base);
                const glm::dvec3 airy = color_of([&](double wavelength) {
                    const std::complex<double> turn =
                        std::polar(1.0, 4.0 * std::numbers::pi * n * thickness / wavelength);
                    return std::norm((r12 + r23 * turn) / (1.0 + r12 * r23 * turn));
                });
                const double root = (base - 1.0) / (base + 1.0);
                const FilmLight light = film_light(film, 1.0f);
                const glm::vec3 found = thin_film_reflectances(light, glm::vec3(float(root * root)));
                // First order: what its cosine is off by. Then the second's, which may be off by as much at
                // twice the path length; and all later ones, whose cosines are at most 1 (Rec. 709 adds to that).
                const double both = std::fabs(r12 * r23), passes = 1.0 - r12 * r12;
                const double order =
                    2.0 * std::fabs(passes * passes * r23 * r23 / (1.0 - both * both) - passes) * both;
                const double rest = order * both * both / (1.0 - both) * 2.0;
                for (int i = 0; i < 3; ++i) {
                    const double bound = order * (1.0 + both) * 0.17 + rest + 1e-5;
                    const double clamped = std::clamp(airy[i], 0.0, 1.0);
                    EXPECT_NEAR(found[i], clamped, bound) << n << " " << base << " " << thickness;
                    largest_error = std::max(largest_error, std::fabs(double(found[i]) - clamped));
                }
            }
        }
    }
    std::printf("largest error %.4f\n", largest_error);
}

// A quarter of a wave of the root of the base's index reflects nothing of that wave's length: so little of
// the colour around it that less than a tenth of what the bare base reflects is left.
TEST(ThinFilm, AQuarterWaveCoatingIsAntireflective) {
    const double base = 1.9, n = std::sqrt(base), wavelength = 550.0;
    const ThinFilm film = make_film(1.0f, 1.0f, float(n), float(wavelength / (4.0 * n)));
    const double root = (base - 1.0) / (base + 1.0);
    const glm::vec3 left = thin_film_reflectances(film_light(film, 1.0f), glm::vec3(float(root * root)));
    EXPECT_LT(left.y, 0.1 * root * root);
    // Half a wave leaves what the base is.
    const ThinFilm half = make_film(1.0f, 1.0f, float(n), float(wavelength / (2.0 * n)));
    const glm::vec3 all = thin_film_reflectances(film_light(half, 1.0f), glm::vec3(float(root * root)));
    EXPECT_GT(all.y, 0.8 * root * root);
}

TEST(ThinFilm, AirOrZeroThicknessIsNoFilm) {
    for (const ThinFilm& film : {make_film(1.0f, 1.0f, 2.0f, 0.0f), make_film(1.0f, 1.0f, 1.0f, 400.0f)}) {
        for (const float f0 : {0.0f, 0.02f, 0.04f, 0.3f, 0.9f, 1.0f}) {
            for (int i = 0; i <= 100; ++i) {
                const float cosine = float(i) / 100.0f;
                const float found = thin_film_reflectances(film_light(film, cosine), glm::vec3(f0)).y;
                const float plain = f0 + (1.0f - f0) * shading::schlick_weight(cosine);
                EXPECT_NEAR(found, plain, 1e-6f) << f0 << " " << cosine;
            }
        }
    }
}

// Nor does it change any lobe, of facets at first and late or of the base: up to the steps that its means are
// taken with.
TEST(ThinFilm, ZeroThicknessChangesNoLobe) {
    for (const float metallic : {0.0f, 1.0f}) {
        shading::MaterialSample material_sample =
            shading::default_material_sample(glm::vec3(0.3f), metallic, 0.9f, 0.0f, 1.5f, 1.5f);
        material_sample.specular = 0.5f;
        const glm::vec3 out(0.6f, 0.0f, 0.8f);
        const shading::Bsdf plain = test::make_bsdf(material_sample, make_mixture(material_sample), out);
        material_sample.lobes = shading::FeatureIridescence;
        material_sample.film = make_film(1.0f, material_sample.specular, 1.8f, 0.0f);
        const shading::Bsdf filmed = test::make_bsdf(material_sample, make_mixture(material_sample), out);
        for (const float x : {-0.9f, -0.6f, 0.0f, 0.8f}) {
            const glm::vec3 in(x, 0.0f, std::sqrt(1.0f - x * x));
            const auto bare = evaluate_bsdf(test::energy_table(), plain, out, in);
            const auto covered = evaluate_bsdf(test::energy_table(), filmed, out, in);
            EXPECT_NEAR(covered.value.y / bare.value.y, 1.0f, 0.01f) << metallic << " " << x;
        }
    }
}

// KHR_materials_specular scales what a film on a dielectric reflects.
TEST(ThinFilm, OnADielectricIsWeightedByItsSpecular) {
    const FilmLight light = film_light(make_film(1.0f, 0.5f, 1.8f, 300.0f), 0.8f);
    const glm::vec3 half = thin_film_dielectric(make_film(1.0f, 0.5f, 1.8f, 300.0f), light, glm::vec3(0.02f));
    const glm::vec3 all = thin_film_dielectric(make_film(1.0f, 1.0f, 1.8f, 300.0f), light, glm::vec3(0.04f));
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(half[i], 0.5f * all[i], 1e-6f);
    EXPECT_EQ(thin_film_dielectric(make_film(1.0f, 0.0f, 1.8f, 300.0f), light, glm::vec3(0.0f)),
              glm::vec3(0.0f));
}

// White metal loses nothing under any film, nor does anything at grazing angles.
TEST(ThinFilm, PreservesWhite) {
    for (const float n : {1.0f, 1.3f, 2.0f, 100.0f}) {
        for (const float thickness : {0.0f, 1.0f, 300.0f, 1e5f, 1e30f}) {
            const ThinFilm film = make_film(1.0f, 1.0f, n, thickness);
            for (int i = 0; i <= 50; ++i) {
                const FilmLight light = film_light(film, float(i) / 50.0f);
                EXPECT_NEAR(thin_film_reflectances(light, glm::vec3(1.0f)).x, 1.0f, 1e-5f)
                    << n << " " << thickness;
            }
            EXPECT_EQ(thin_film_reflectances(film_light(film, 0.0f), glm::vec3(0.04f)).x, 1.0f);
        }
    }
}

// The bound by which the base below is dimmed, and the means by which facets light each other.
TEST(ThinFilm, MeansAndBoundMatchTheReflectance) {
    double most_over = 0.0, most_off = 0.0;
    for (const float n : {1.2f, 1.33f, 1.5f, 1.8f, 2.4f}) {
        for (const float f0 : {0.02f, 0.04f, 0.1f}) {
            for (const float thickness : {50.0f, 150.0f, 300.0f, 450.0f, 800.0f, 1200.0f}) {
                const ThinFilm film = make_film(1.0f, 0.8f, n, thickness);
                const auto mean = shading::film_mean(film, glm::vec3(0.8f * f0), glm::vec3(0.7f));
                glm::dvec3 dielectric(0.0), metal(0.0);
                double over = 0.0;
                constexpr int Steps = 1000;
                for (int i = 0; i < Steps; ++i) {
                    const float cosine = (float(i) + 0.5f) / Steps;
                    const FilmLight light = film_light(film, cosine);
                    const glm::vec3 here = shading::thin_film_dielectric(film, light, glm::vec3(0.8f * f0));
                    const double weight = 2.0 * double(cosine) / Steps;
                    dielectric += weight * glm::dvec3(here);
                    metal += weight * glm::dvec3(thin_film_reflectances(light, glm::vec3(0.7f)));
                    const float bound = mean.f0 + (mean.f90 - mean.f0) * shading::schlick_weight(cosine);
                    over += weight * std::max(0.0, double(shading::largest(here) - bound));
                }
                most_over = std::max(most_over, over);
                for (int i = 0; i < 3; ++i) {
                    most_off = std::max({most_off, std::fabs(dielectric[i] - double(mean.dielectric[i])),
                                         std::fabs(metal[i] - double(mean.metal[i]))});
                }
            }
        }
    }
    std::printf("over the bound by %.5f, off the mean by %.5f\n", most_over, most_off);
    EXPECT_LT(most_over, 1e-3);
    EXPECT_LT(most_off, 0.01);
}

// Along one path, from the air and from inside.
TEST(ThinFilm, OnGlassIsTheSameFromBothSides) {
    for (const float n : {1.33f, 1.5f, 2.0f}) {
        shading::RoughGlass into = test::clear_boundary(n), out_of = test::clear_boundary(1.0f / n);
        into.film = out_of.film = make_film(0.9f, 1.0f, 1.4f, 350.0f);
        for (int i = 5; i <= 100; ++i) {
            const float cosine = float(i) / 100.0f;
            const float sine2 = (1.0f - cosine) * (1.0f + cosine);
            const float inside = std::sqrt(shading::refracted_cosine2(cosine, sine2, n));
            const glm::vec3 there = adjusted_fresnel(into, cosine), again = adjusted_fresnel(out_of, inside);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(there[c], again[c], 2e-5f / cosine) << n << " " << cosine;
        }
        EXPECT_EQ(adjusted_fresnel(out_of, 0.1f), glm::vec3(1.0f)) << "total reflection is total";
    }
}

// ---- pictures ----

scene::Material filmed(float metallic, float thickness) {
    return {.base_color = {0.9f, 0.6f, 0.3f, 1.0f},
            .metallic = metallic,
            .roughness = 0.0f,
            .iridescence = 0.75f,
            .iridescence_index_of_refraction = 1.6f,
            .iridescence_thickness_minimum = 0.0f,
            .iridescence_thickness_maximum = thickness};
}

glm::dvec3 seen(Model& model) {
    const SceneAdapter& world = model.build();
    glm::dvec3 sum(0.0);
    double n = 0.0;
    for_samples(world, small_view({0.0, 0.0, 1.0}, 0.01), 4, [&](const PathSample& sample) {
        sum += glm::dvec3(radiance_of(sample));
        n += 1.0;
    });
    return sum / n;
}

// A mirror straight below under a white sky.
TEST(ThinFilm, IsVisibleInAMirror) {
    Model model;
    model.floor(model.material(filmed(1.0f, 420.0f)), 10.0f, 0.0f);
    model.sky(glm::vec3(1.0f));
    const glm::dvec3 found = seen(model);
    const glm::vec3 base(0.9f, 0.6f, 0.3f);
    const glm::vec3 film =
        thin_film_reflectances(film_light(make_film(1.0f, 1.0f, 1.6f, 420.0f), 1.0f), base);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], 0.25f * base[i] + 0.75f * film[i], 1e-3) << i;
    EXPECT_TRUE(model.problems.empty());
}

// Strength from red, thickness between its ends from green.
TEST(ThinFilm, FollowsItsTextures) {
    Model model;
    scene::Material material = filmed(1.0f, 500.0f);
    material.iridescence_thickness_minimum = 200.0f;
    material.iridescence_texture = material.iridescence_thickness_texture =
        model.texture(scene::Texture{.width = 1, .height = 1, .format = scene::TexelFormat::Rgba8},
                      std::vector<std::uint32_t>{0xff00'3380u});
    model.textured_quad(model.material(material), {{{-10, -10, 0}, {10, -10, 0}, {10, 10, 0}, {-10, 10, 0}}},
                        1.0f);
    model.sky(glm::vec3(1.0f));
    const glm::dvec3 found = seen(model);
    const glm::vec3 base(0.9f, 0.6f, 0.3f);
    const float strength = 0.75f * 128.0f / 255.0f;
    const ThinFilm film = make_film(strength, 1.0f, 1.6f, 200.0f + 300.0f * 0.2f);
    const glm::vec3 all = thin_film_reflectances(film_light(film, 1.0f), base);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(found[i], base[i] + strength * (all[i] - base[i]), 1e-3) << i;
    }
}

}  // namespace
}  // namespace tessera::embree
