// Every lobe that materials lower to: it draws what its density says, never gives back more than comes in,
// and is reciprocal; tabulated values match sampling.
#include "tests/statistics/lobes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "mediator/base/random.h"
#include "tests/statistics/chi_squared.h"

namespace tessera::shading {
namespace {

using test::energy_table;

glm::vec2 pair(CounterRandom& random) {
    return {static_cast<float>(random.uniform()) * 0.99999994f,
            static_cast<float>(random.uniform()) * 0.99999994f};
}

MaterialSample rough_glass(float roughness, float eta) {
    MaterialSample material_sample =
        default_material_sample(vec3(1.0f), 0.0f, roughness, 1.0f, eta > 1.0f ? eta : 1.0f / eta, eta);
    material_sample.lobes = FeatureRoughGlass;
    return material_sample;
}

// A white material of each lobe, and one of all.
MaterialSample material_sample_named(const std::string& name, float roughness) {
    MaterialSample material_sample = default_material_sample(
        vec3(1.0f), name == "metal" || name == "brushed" ? 1.0f : 0.0f, roughness, 0.0f, 1.5f, 1.5f);
    if (name == "mixed") material_sample.metallic = 0.5f;
    if (name == "brushed") material_sample.alpha.x = std::max(material_sample.alpha.x, 0.5f);
    if (name == "from air") return rough_glass(roughness, 1.5f);
    if (name == "from inside") return rough_glass(roughness, 1.0f / 1.5f);
    if (name == "thin") {
        material_sample = rough_glass(roughness, 1.5f);
        material_sample.thin = 1;
    }
    if (name == "coat" || name == "all") {
        material_sample.lobes |= FeatureCoat;
        material_sample.coat = 0.8f;
        material_sample.coat_roughness = roughness;
        material_sample.alpha = vec2(0.3f);
    }
    if (name == "sheen" || name == "all") {
        material_sample.lobes |= FeatureSheen;
        material_sample.sheen_color = vec3(1.0f);
        material_sample.sheen_roughness = roughness;
        material_sample.alpha = vec2(0.3f);
    }
    if (name == "film on metal" || name == "film on dielectric" || name == "film on glass" ||
        name == "film on all") {
        if (name == "film on metal") material_sample.metallic = 1.0f;
        if (name == "film on all") material_sample.metallic = 0.4f;
        if (name == "film on glass" || name == "film on all") {
            material_sample.transmission = 0.7f;
            material_sample.lobes |= FeatureRoughGlass;
        }
        material_sample.lobes |= FeatureIridescence;
        material_sample.film = make_film(name == "film on all" ? 0.8f : 1.0f, 1.0f, 1.7f, 320.0f);
    }
    if (name == "all") {
        material_sample.metallic = 0.3f;
        material_sample.transmission = 0.5f;
        material_sample.lobes |= FeatureRoughGlass;
        material_sample.specular = 0.7f;
        material_sample.specular_color = vec3(0.5f, 1.0f, 2.0f);
        material_sample.alpha = vec2(0.4f, 0.2f);
    }
    return material_sample;
}

const char* const Names[] = {
    "metal", "dielectric", "mixed", "brushed",       "from air",           "from inside",   "thin",
    "coat",  "sheen",      "all",   "film on metal", "film on dielectric", "film on glass", "film on all"};

glm::vec3 towards(float cosine, float azimuth = 0.7f) {
    const float sine = std::sqrt(1.0f - cosine * cosine);
    return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}

Bsdf bsdf_of(const MaterialSample& material_sample, const glm::vec3& out) {
    return test::make_bsdf(material_sample, make_mixture(material_sample), out);
}

struct Reflected {
    double mean, error;
};

Reflected reflected(const MaterialSample& material_sample, const glm::vec3& out, int samples) {
    CounterRandom random(9);
    const Bsdf bsdf = bsdf_of(material_sample, out);
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < samples; ++i) {
        const glm::vec3 in = sample_bsdf(bsdf, out, static_cast<float>(random.uniform()), pair(random));
        const BsdfValue value = evaluate_bsdf(energy_table(), bsdf, out, in);
        const double weight = value.pdf > 0.0f ? double(value.value.y) / double(value.pdf) : 0.0;
        sum += weight;
        squares += weight * weight;
    }
    const double mean = sum / samples;
    return {mean, std::sqrt(std::max(0.0, squares / samples - mean * mean) / samples)};
}

class Lobes : public testing::TestWithParam<const char*> {};

TEST_P(Lobes, SamplesFollowTheDensity) {
    for (const float roughness : {0.4f, 0.7f, 1.0f}) {
        for (const float cosine : {0.9f, 0.3f}) {
            const glm::vec3 out = towards(cosine);
            const Bsdf bsdf = bsdf_of(material_sample_named(GetParam(), roughness), out);
            SCOPED_TRACE(testing::Message() << roughness << " " << cosine);
            test::expect_directions(
                [&](CounterRandom& random) {
                    return sample_bsdf(bsdf, out, static_cast<float>(random.uniform()), pair(random));
                },
                [&](const glm::vec3& in) { return double(evaluate_bsdf(energy_table(), bsdf, out, in).pdf); },
                test::Losses::Allowed);
        }
    }
}

TEST_P(Lobes, ConserveEnergy) {
    for (const float roughness : {0.0f, 0.02f, 0.1f, 0.3f, 0.6f, 1.0f}) {
        for (const float cosine : {1.0f, 0.7f, 0.3f, 0.1f, 0.02f, 0.001f}) {
            const MaterialSample material_sample = material_sample_named(GetParam(), roughness);
            const auto [mean, error] = reflected(material_sample, towards(cosine), 20'000);
            std::printf("%-18s roughness %.2f cos %.3f: %.4f +- %.4f\n", GetParam(), double(roughness),
                        double(cosine), mean, error);
            // 504 of these: 4.5 standard errors. The tables' steps: 0.3 %, seen below cosines of 0.1 only.
            EXPECT_LE(mean, 1.0 + 4.5 * error + (cosine > 0.1f ? 1e-3 : 3e-3)) << roughness << " " << cosine;
        }
    }
}

TEST_P(Lobes, AreReciprocal) {
    CounterRandom random(10);
    for (const float roughness : {0.1f, 0.3f, 0.6f, 1.0f}) {
        const MaterialSample material_sample = material_sample_named(GetParam(), roughness);
        for (int i = 0; i < 2000; ++i) {
            const glm::vec3 a = sample_cosine_hemisphere(pair(random)),
                            b = sample_cosine_hemisphere(pair(random));
            if (!(a.z > 1e-2f) || !(b.z > 1e-2f)) continue;
            const double there =
                evaluate_bsdf(energy_table(), bsdf_of(material_sample, a), a, b).value.y / b.z;
            const double again =
                evaluate_bsdf(energy_table(), bsdf_of(material_sample, b), b, a).value.y / a.z;
            EXPECT_NEAR(there, again, 1e-4 * std::max(there, again) + 1e-6) << roughness;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(All, Lobes, testing::ValuesIn(Names), [](const auto& named) {
    std::string name(named.param);
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
});

// White metal and white dielectric give back all: what facets send to each other is not lost.
TEST(Energy, WhiteFurnaceOfWhiteMaterials) {
    for (const char* name : {"metal", "dielectric", "mixed"}) {
        for (const float roughness : {0.2f, 0.5f, 0.8f, 1.0f}) {
            for (const float cosine : {1.0f, 0.6f, 0.2f}) {
                const auto [mean, error] =
                    reflected(material_sample_named(name, roughness), towards(cosine), 200'000);
                EXPECT_LE(error, 0.003);
                EXPECT_NEAR(mean, 1.0, 4.0 * error + 1e-3) << name << " " << roughness << " " << cosine;
            }
        }
    }
}

// Films of any thickness and index over white: in no channel more comes back than came in, and in the mean
// over these little of it is lost. What is lost is what the base is dimmed too much: it is by the same for
// all channels, and by a bound.
TEST(Energy, FilmsOverWhiteConserveEnergy) {
    double lost = 0.0, count = 0.0;
    for (const float index : {1.15f, 1.33f, 1.8f, 2.4f}) {
        for (const float thickness : {60.0f, 200.0f, 350.0f, 700.0f, 1500.0f}) {
            for (const float roughness : {0.1f, 0.4f, 0.9f}) {
                for (const float cosine : {1.0f, 0.5f, 0.1f}) {
                    MaterialSample material_sample =
                        default_material_sample(vec3(1.0f), 0.0f, roughness, 0.0f, 1.5f, 1.5f);
                    material_sample.lobes = FeatureIridescence;
                    material_sample.film = make_film(1.0f, 1.0f, index, thickness);
                    const glm::vec3 out = towards(cosine);
                    const Bsdf bsdf = bsdf_of(material_sample, out);
                    CounterRandom random(12);
                    glm::dvec3 sum(0.0), squares(0.0);
                    constexpr int Samples = 20'000;
                    for (int i = 0; i < Samples; ++i) {
                        const glm::vec3 in =
                            sample_bsdf(bsdf, out, static_cast<float>(random.uniform()), pair(random));
                        const BsdfValue value = evaluate_bsdf(energy_table(), bsdf, out, in);
                        if (!(value.pdf > 0.0f)) continue;
                        const glm::dvec3 weight(value.value / value.pdf);
                        sum += weight;
                        squares += weight * weight;
                    }
                    const glm::dvec3 mean = sum / double(Samples);
                    for (int i = 0; i < 3; ++i) {
                        const double variance = std::max(0.0, squares[i] / Samples - mean[i] * mean[i]);
                        // 540 of these: 4.5 standard errors; the tables' steps as above.
                        EXPECT_LE(mean[i], 1.0 + 4.5 * std::sqrt(variance / Samples) + 3e-3)
                            << index << " " << thickness << " " << roughness << " " << cosine;
                        lost += 1.0 - mean[i];
                        count += 1.0;
                    }
                }
            }
        }
    }
    std::printf("lost in the mean: %.4f\n", lost / count);
    EXPECT_LT(lost / count, 0.06);
}

// The base is attenuated by the smaller of the transmittances of both directions, not by their product.
TEST(Coat, AttenuatesTheBaseByTheSmallerTransmittance) {
    MaterialSample material_sample = default_material_sample(vec3(1.0f), 0.0f, 0.6f, 0.0f, 1.5f, 1.5f);
    material_sample.lobes = FeatureCoat;
    material_sample.coat_roughness = 0.3f;
    for (const float cosine : {0.9f, 0.4f}) {
        const glm::vec3 out = towards(cosine), in = towards(0.7f, 2.9f);
        const double bare = evaluate_bsdf(energy_table(), bsdf_of(material_sample, out), out, in).diffuse.y;
        material_sample.coat = 0.75f;
        const double dimmed = evaluate_bsdf(energy_table(), bsdf_of(material_sample, out), out, in).diffuse.y;
        material_sample.coat = 0.0f;
        const auto passes = [](float cos) {
            const vec2 energy = lobe_energy(energy_table(), cos, 0.3f);
            return 1.0 - 0.75 * (0.04 * double(energy.x) + double(energy.y));
        };
        EXPECT_NEAR(dimmed / bare, std::min(passes(cosine), passes(0.7f)), 1e-5) << cosine;
    }
}

// A coat with a separate normal is evaluated in the frame of that normal.
TEST(Coat, HasItsOwnNormal) {
    MaterialSample material_sample = default_material_sample(vec3(0.0f), 1.0f, 0.5f, 0.0f, 1.5f, 1.5f);
    material_sample.lobes = FeatureCoat;
    material_sample.coat = 1.0f;
    material_sample.coat_roughness = 0.5f;
    const auto coat = [&](const glm::vec3& normal, const glm::vec3& out, const glm::vec3& in) {
        material_sample.coat_normal = normal;
        BsdfValue value{};
        add_coat(value, bsdf_of(material_sample, out), out, in);
        return double(value.value.y);
    };
    const glm::vec3 normal = towards(0.9f, 1.0f), up(0.0f, 0.0f, 1.0f);
    const mat3 frame = frame_around(normal);
    for (const float azimuth : {0.0f, 2.0f, 4.0f}) {
        const glm::vec3 out = towards(0.8f, azimuth), in = towards(0.6f, azimuth + 2.5f);
        const double there = coat(normal, out, in);
        EXPECT_NEAR(there, coat(up, out * frame, in * frame), 1e-5 * there) << azimuth;
        EXPECT_GT(std::fabs(there - coat(up, out, in)), 1e-2 * there) << azimuth;
    }
}

// The projected areas of a sheen's fibres sum to that of the surface.
TEST(Sheen, CoversTheSurface) {
    for (const float alpha : {0.05f, 0.2f, 0.6f, 1.0f}) {
        double sum = 0.0;
        constexpr int Steps = 20'000;
        for (int i = 0; i < Steps; ++i) {
            const double sine = (i + 0.5) / Steps;  // cos sin d(angle) = sin d(sin)
            const glm::vec3 h(float(sine), 0.0f, float(std::sqrt(1.0 - sine * sine)));
            sum += double(sheen_distribution(h, alpha)) * sine * 2.0 * double(Pi) / Steps;
        }
        EXPECT_NEAR(sum, 1.0, 1e-3) << alpha;
    }
}

// Light that goes through is not lost at the other side: from air into glass as from glass into air, with the
// factor of solid angles, eta^2, that basic radiance leaves out.
TEST(RoughGlass, IsReciprocal) {
    CounterRandom random(11);
    for (const float roughness : {0.2f, 0.5f, 1.0f}) {
        MaterialSample into = material_sample_named("from air", roughness),
                       out_of = material_sample_named("from inside", roughness);
        for (int i = 0; i < 2000; ++i) {
            if (i == 1000) into.film = out_of.film = make_film(1.0f, 1.0f, 1.8f, 400.0f);
            const glm::vec3 a = sample_cosine_hemisphere(pair(random)),
                            below = sample_cosine_hemisphere(pair(random));
            if (!(a.z > 1e-2f) || !(below.z > 1e-2f)) continue;
            const glm::vec3 down(below.x, below.y, -below.z), up(a.x, a.y, -a.z);
            const double there = evaluate_bsdf(energy_table(), bsdf_of(into, a), a, down).value.y / below.z;
            const double again =
                evaluate_bsdf(energy_table(), bsdf_of(out_of, below), below, up).value.y / a.z;
            EXPECT_NEAR(there / (1.5 * 1.5), again, 1e-3 * again + 1e-5) << roughness;
        }
    }
}

// What single scattering loses between the facets comes back by multiple scattering, reflected or transmitted: white
// glass loses nothing from either side. The table's steps: 0.3 %.
TEST(RoughGlass, KeepsAllLight) {
    for (const float index : {1.05f, 1.33f, 1.5f, 2.4f}) {
        for (const char* const name : {"from air", "from inside", "thin"}) {
            for (const float roughness : {0.2f, 0.3f, 0.6f, 1.0f}) {
                MaterialSample material_sample = material_sample_named(name, roughness);
                material_sample.index_of_refraction = index;
                material_sample.eta = std::string(name) == "from inside" ? 1.0f / index : index;
                for (const float cosine : {1.0f, 0.7f, 0.4f, 0.15f}) {
                    const auto [mean, error] = reflected(material_sample, towards(cosine), 40'000);
                    // 192 of these: 4.5 standard errors.
                    EXPECT_LE(mean, 1.0 + 4.5 * error + 3e-3)
                        << name << " " << index << " " << roughness << " " << cosine;
                    EXPECT_GE(mean, 1.0 - 4.5 * error - (roughness < 0.3f ? 0.02 : 0.01))
                        << name << " " << index << " " << roughness << " " << cosine;
                }
            }
        }
    }
}

// Thin walls do not refract: transmission is the mirror image of reflection.
TEST(RoughGlass, ThinWallsAreSymmetric) {
    const MaterialSample material_sample = material_sample_named("thin", 0.5f);
    const glm::vec3 out = towards(0.8f);
    const Bsdf bsdf = bsdf_of(material_sample, out);
    for (const float cosine : {0.9f, 0.5f, 0.1f}) {
        const glm::vec3 in = towards(cosine, 3.0f);
        const glm::vec3 h = glm::normalize(in + out);
        const double f = double(fresnel_dielectric(glm::dot(in, h), 1.5f));
        const double up = evaluate_rough_glass(bsdf.glass, out, in).value.y;
        const double down = evaluate_rough_glass(bsdf.glass, out, {in.x, in.y, -in.z}).value.y;
        EXPECT_NEAR(down / up, (1.0 - f) / f, 1e-4 * (1.0 - f) / f);
    }
}

}  // namespace
}  // namespace tessera::shading
