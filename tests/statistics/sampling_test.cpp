// Every sampling routine draws what its density says (chi-squared), and the surface model keeps its promises.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>

#include "mediator/backend/tables/tables.h"
#include "mediator/base/random.h"
#include "mediator/shading/bsdf.h"
#include "mediator/shading/environment.h"
#include "tests/statistics/chi_squared.h"
#include "tests/statistics/lobes.h"

namespace tessera::shading {
namespace {

using namespace test;

glm::vec2 uniform_pair(CounterRandom& random) {
    return {static_cast<float>(random.uniform()) * 0.99999994f,
            static_cast<float>(random.uniform()) * 0.99999994f};
}

TEST(Sampling, CosineHemisphere) {
    expect_directions([](CounterRandom& r) { return sample_cosine_hemisphere(uniform_pair(r)); },
                      [](const glm::vec3& w) { return std::max(0.0, double(w.z)) / DoublePi; });
}

TEST(Sampling, Sphere) {
    expect_directions([](CounterRandom& r) { return sample_sphere(uniform_pair(r)); },
                      [](const glm::vec3&) { return 1.0 / (4.0 * DoublePi); });
}

TEST(Sampling, TriangleIsUniform) {
    CounterRandom random(6);
    constexpr int Edge = 10;
    std::vector<double> observed(Edge * Edge), expected(Edge * Edge);
    for (int i = 0; i < Samples; ++i) {
        const glm::vec2 b = sample_triangle(uniform_pair(random));
        ASSERT_TRUE(b.x >= 0.0f && b.y >= 0.0f && b.x + b.y <= 1.000001f);
        ++observed[static_cast<std::size_t>(std::min(9, int(b.x * Edge)) * Edge +
                                            std::min(9, int(b.y * Edge)))];
    }
    for (int x = 0; x < Edge; ++x) {
        for (int y = 0; y < Edge; ++y) {
            const double part = x + y < Edge - 1 ? 1.0 : (x + y == Edge - 1 ? 0.5 : 0.0);
            expected[static_cast<std::size_t>(x * Edge + y)] = part * 2.0 / (Edge * Edge) * Samples;
        }
    }
    expect_fit(observed, expected);
}

void expect_offsets(float (*offset)(float, float), const std::function<double(double)>& density) {
    constexpr int Cells = 50, Fine = 200;
    constexpr float Radius = 1.5f;
    CounterRandom random(7);
    std::vector<double> observed(Cells), expected(Cells);
    double total = 0.0;
    for (int i = 0; i < Samples; ++i) {
        const float x = offset(static_cast<float>(random.uniform()), Radius);
        ASSERT_LE(std::fabs(x), Radius * 1.0001f);
        ++observed[static_cast<std::size_t>(
            std::clamp(int((x / Radius + 1.0f) / 2.0f * Cells), 0, Cells - 1))];
    }
    for (int i = 0; i < Cells * Fine; ++i) {
        const double value = density(-1.0 + 2.0 * (i + 0.5) / (Cells * Fine));
        expected[static_cast<std::size_t>(i / Fine)] += value;
        total += value;
    }
    for (double& value : expected) value *= Samples / total;
    expect_fit(observed, expected);
}

TEST(Sampling, GaussianPixelFilter) {
    expect_offsets(gaussian_offset, [](double t) { return std::exp(-0.5 * 9.0 * t * t); });
}

TEST(Sampling, BlackmanHarrisPixelFilter) {
    expect_offsets(blackman_harris_offset, [](double t) {
        const double x = DoublePi * (t + 1.0);
        return 0.35875 - 0.48829 * std::cos(x) + 0.14128 * std::cos(2.0 * x) - 0.01168 * std::cos(3.0 * x);
    });
}

TEST(Sampling, EnvironmentMap) {
    constexpr std::uint32_t Width = 16, Height = 8;
    std::vector<glm::vec3> texels(Width * Height, glm::vec3(0.2f));
    texels[3 * Width + 5] = glm::vec3(40.0f);
    texels[6 * Width + 0] = glm::vec3(5.0f);
    const auto blobs = std::make_shared<scene::BlobStore>();
    const scene::BlobPtr blob = blobs->insert(std::as_bytes(std::span(texels)));
    constexpr ObjectId Sky{2}, Map{3};
    scene::Scene described;
    ASSERT_TRUE(described.apply_entries(
        {scene::Create{scene::RootId, scene::Root{.background = Sky}},
         scene::Create{Sky, scene::Background{.environment = Map, .strength = 1.0f, .rotation = 0.7f}},
         scene::Create{Map, scene::Texture{.width = Width,
                                           .height = Height,
                                           .format = scene::TexelFormat::RgbFloat,
                                           .texels = scene::reference(*blob)}}}));
    backend::MipmapCache mipmaps;
    const auto tables = backend::make_tables(described, {}, backend::MeshCatalog(blobs), *blobs, mipmaps);
    const Scene sky = backend::on_host(tables);
    expect_directions([&](CounterRandom& r) { return sample_sky(sky, uniform_pair(r)); },
                      [&](const glm::vec3& w) { return double(sky_at(sky, w).pdf); });
}

class SurfaceModel : public testing::TestWithParam<std::tuple<float, float, float>> {
  protected:
    float roughness = std::get<0>(GetParam()), metallic = std::get<1>(GetParam()),
          cosine = std::get<2>(GetParam());
    glm::vec3 out{std::sqrt(1.0f - cosine * cosine), 0.0f, cosine};
    shading::MaterialSample material_sample =
        shading::default_material_sample(glm::vec3(1.0f), metallic, roughness, 0.0f, 1.5f, 1.5f);
    shading::FloatArray table = test::energy_table();
    Bsdf bsdf = test::make_bsdf(material_sample, {metallic, 1.0f - metallic}, out);
};

// Lobes that are wide against the cells.
class WideSurfaceModel : public SurfaceModel {};

TEST_P(WideSurfaceModel, SamplesFollowTheDensity) {
    // Directions below the surface are sampled with zero weight: they are a separate cell, by what is left
    // of 1.
    CounterRandom random(8);
    std::vector<double> observed(Rows * Columns + 1);
    std::vector<double> expected =
        integrate([&](const glm::vec3& w) { return double(evaluate_bsdf(table, bsdf, out, w).pdf); });
    double above = 0.0;
    for (double& value : expected) {
        above += value;
        value *= Samples;
    }
    EXPECT_LE(above, 1.002);
    expected.push_back((1.0 - std::min(above, 1.0)) * Samples);
    for (int i = 0; i < Samples; ++i) {
        const float choice = static_cast<float>(random.uniform());
        const glm::vec3 in = sample_bsdf(bsdf, out, choice, uniform_pair(random));
        ++observed[in.z > 0.0f ? cell(in) : observed.size() - 1];
    }
    expect_fit(observed, expected);
}

// White furnace: a white surface under light 1 from everywhere never gives back more than 1.
TEST_P(SurfaceModel, ConservesEnergy) {
    CounterRandom random(9);
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < Samples; ++i) {
        const glm::vec3 in =
            sample_bsdf(bsdf, out, static_cast<float>(random.uniform()), uniform_pair(random));
        const BsdfValue value = evaluate_bsdf(table, bsdf, out, in);
        const double weight = value.pdf > 0.0f ? double(value.value.x) / double(value.pdf) : 0.0;
        sum += weight;
        squares += weight * weight;
    }
    const double mean = sum / Samples,
                 error = std::sqrt(std::max(0.0, squares / Samples - mean * mean) / Samples);
    std::printf("roughness %.3f metallic %.0f cos %.2f: reflects %.4f +- %.4f\n", double(roughness),
                double(metallic), double(cosine), mean, error);
    EXPECT_LE(mean, 1.0 + 4.0 * error + 1e-5);
    EXPECT_GT(mean, 0.3);
}

TEST_P(SurfaceModel, IsReciprocal) {
    CounterRandom random(10);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 in = sample_cosine_hemisphere(uniform_pair(random));
        if (!(in.z > 1e-3f)) continue;
        const Bsdf back = test::make_bsdf(material_sample, {metallic, 1.0f - metallic}, in);
        const double there = evaluate_bsdf(table, bsdf, out, in).value.x / in.z;
        const double again = evaluate_bsdf(table, back, in, out).value.x / out.z;
        EXPECT_NEAR(there, again, 1e-4 * std::max(there, again) + 1e-6);
    }
}

INSTANTIATE_TEST_SUITE_P(Surfaces, SurfaceModel,
                         testing::Combine(testing::Values(0.0f, 0.1f, 0.35f, 0.6f, 1.0f),
                                          testing::Values(0.0f, 1.0f), testing::Values(1.0f, 0.5f, 0.1f)));

INSTANTIATE_TEST_SUITE_P(Surfaces, WideSurfaceModel,
                         testing::Combine(testing::Values(0.35f, 0.6f, 1.0f), testing::Values(0.0f, 1.0f),
                                          testing::Values(1.0f, 0.5f, 0.1f)));

}  // namespace
}  // namespace tessera::shading
