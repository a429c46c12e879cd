// Surfaces that let a part of the light through.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

// Sheets of this alpha in front of a lamp of radiance 1.
struct Sheets : Model {
    Sheets(int count, float alpha) {
        floor(material(lamp(1.0f)), 10.0f, 0.0f);
        scene::Material veil = chalk(glm::vec3(0.0f));
        veil.base_color.w = alpha;
        veil.alpha_mode = scene::AlphaMode::Blend;
        for (int i = 0; i < count; ++i) floor(material(veil), 10.0f, 0.1f * static_cast<float>(i + 1));
    }
};

// Of one triangle. Deviation of a pixel's mean of `spp` samples from the expectation, over 16 x 16 pixels.
struct Deviation {
    double mean = 0.0, rms = 0.0;
};
Deviation deviation(int sheets, float alpha, std::uint64_t spp) {
    Sheets model(sheets, alpha);
    std::vector<double> sums(256);
    std::size_t i = 0;
    view::View view = small_view({5.0, -5.0, 3.0}, 0.5);
    view.max_bounces = 0;
    for_samples(model.build(), view, spp, [&](const PathSample& sample) { sums[i++ % 256] += red(sample); });
    const double expected = std::pow(1.0 - double(alpha), sheets);
    Deviation found;
    for (const double sum : sums) {
        const double off = sum / double(spp) - expected;
        found.mean += off / 256.0;
        found.rms += off * off / 256.0;
    }
    found.rms = std::sqrt(found.rms);
    return found;
}

// Independent numbers: sqrt(0.37 x 0.63 / n) = 0.121 at 16 and 0.030 at 256.
TEST(Alpha, OfOneSheetIsStratified) {
    EXPECT_LT(deviation(1, 0.37f, 16).rms, 0.03);
    EXPECT_LT(deviation(1, 0.37f, 256).rms, 0.003);
    EXPECT_LT(std::fabs(deviation(1, 0.37f, 256).mean), 4.0 * 0.003 / 16.0);
}

// The numbers of different sheets are independent of each other.
TEST(Alpha, OfSeveralSheetsMultiplies) {
    for (const int sheets : {2, 3, 8}) {
        const double passed = std::pow(0.75, sheets);
        const Deviation found = deviation(sheets, 0.25f, 256);
        const double independent = std::sqrt(passed * (1.0 - passed) / 256.0);
        EXPECT_LT(found.rms, 1.1 * independent) << sheets;
        EXPECT_LT(std::fabs(found.mean), 4.0 * independent / 16.0) << sheets;
    }
}

// Shadow rays have numbers of their own: half of the light passes each way.
TEST(Alpha, OfShadowsIsStratified) {
    Model model;
    model.floor(model.material(chalk(glm::vec3(1.0f))), 10.0f, 0.0f);
    scene::Material veil = chalk(glm::vec3(0.0f));
    veil.base_color.w = 0.5f;
    veil.alpha_mode = scene::AlphaMode::Blend;
    model.floor(model.material(veil), 10.0f, 2.0f);
    model.light({.kind = scene::LightKind::Directional, .intensity = glm::vec3(static_cast<float>(M_PI))},
                glm::dmat4(1.0));
    std::vector<double> sums(256);
    std::size_t i = 0;
    view::View view = small_view({5.0, -5.0, 1.0}, 0.5);
    view.max_bounces = 0;
    for_samples(model.build(), view, 64, [&](const PathSample& sample) { sums[i++ % 256] += red(sample); });
    double squares = 0.0;
    for (const double sum : sums) squares += std::pow(sum / 64.0 - 0.5, 2.0) / 256.0;
    EXPECT_LT(std::sqrt(squares), 0.01) << "0.0625 by independent numbers";
}

}  // namespace
}  // namespace tessera::embree
