// A diffuse plane under every kind of light, against closed forms; and the three strategies against each
// other.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "backends/embree/path_tracer.h"
#include "backends/embree/scene_adapter.h"

namespace tessera::embree {
namespace {

using namespace scene;
constexpr double Pi = std::numbers::pi;
constexpr float Albedo = 0.6f;

constexpr ObjectId Ground{2}, GroundMaterial{3}, LampTransform{4}, Lamp{5}, LampMaterial{6}, Sky{7};

// A ground of 400 x 400 m at y = 0, and whatever is added; the camera looks straight down on the origin.
class Stage {
  public:
    Stage() : ground_{.material = GroundMaterial} {
        add_quad(ground_, 200.0f);
        const Material material{.base_color = {Albedo, Albedo, Albedo, 1.0f}, .index_of_refraction = 1.0f};
        entries_.push_back(Create{GroundMaterial, material});
        entries_.push_back(Create{Ground, ground_});
        root_.children.push_back(Ground);
    }

    // Something at height h, turned so that its -z shines down.
    void add_light(const Light& light, double height) {
        const glm::dmat4 place = glm::translate(glm::dmat4(1.0), {0.0, height, 0.0}) *
                                 glm::rotate(glm::dmat4(1.0), -Pi / 2, {1.0, 0.0, 0.0});
        entries_.push_back(Create{Lamp, light});
        hang(place);
    }
    void add_square(float half_edge, double height, float radiance) {
        Geometry square{.material = LampMaterial};
        add_quad(square, half_edge);
        entries_.push_back(Create{Lamp, square});
        entries_.push_back(Create{LampMaterial, Material{.base_color = {0.0f, 0.0f, 0.0f, 1.0f},
                                                         .emission = glm::vec3(radiance),
                                                         .double_sided = true,
                                                         .index_of_refraction = 1.0f}});
        hang(glm::translate(glm::dmat4(1.0), {0.0, height, 0.0}));
    }
    void add_sky(float radiance) {
        entries_.push_back(Create{Sky, Background{.color = glm::vec3(radiance)}});
        root_.background = Sky;
    }

    struct Estimate {
        double mean = 0, standard_error = 0;
    };
    Estimate radiance(Strategy strategy, std::uint64_t spp) {
        Scene scene;
        std::vector<Entry> entries = entries_;
        entries.push_back(Create{RootId, root_});
        EXPECT_TRUE(scene.apply_entries(entries));
        scene.set_version({1, 1});
        SceneAdapter world(device_.get(), blobs_);
        EXPECT_TRUE(world.apply(snapshot(scene)));
        EXPECT_TRUE(world.commit());
        view::View view;
        view.width = view.height = 16;
        view.seed = 3;
        view.max_bounces = 0;
        // From just below any lamp, with a field of view so small that all pixels see the origin.
        const glm::dmat4 eye = glm::translate(glm::dmat4(1.0), {0.0, 0.5, 0.0}) *
                               glm::rotate(glm::dmat4(1.0), -Pi / 2, {1.0, 0.0, 0.0});
        view.camera = view::perspective(eye, 1e-3, 1.0);
        const PathTracer tracer(world.tables(), world.scene(), view, strategy);
        double sum = 0, squares = 0;
        std::uint64_t rays = 0;
        const double count = 256.0 * static_cast<double>(spp);
        for (std::uint64_t i = 0; i < 256 * spp; ++i) {
            const PathSample found = tracer.trace(i % 16, i / 16 % 16, i / 256, rays);
            EXPECT_EQ(found.high, glm::vec3(0.0f)) << "one scattering is direct light";
            sum += found.low.x;
            squares += double(found.low.x) * found.low.x;
        }
        const double mean = sum / count;
        return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / count)};
    }

  private:
    void add_quad(Geometry& geometry, float half_edge) {
        const std::array<glm::vec3, 4> corners{{{-half_edge, 0, -half_edge},
                                                {half_edge, 0, -half_edge},
                                                {half_edge, 0, half_edge},
                                                {-half_edge, 0, half_edge}}};
        constexpr std::array<std::uint32_t, 6> Triangles{0, 2, 1, 0, 3, 2};
        geometry.positions = reference(*blobs_->insert(std::as_bytes(std::span(corners))));
        geometry.indices = reference(*blobs_->insert(std::as_bytes(std::span(Triangles))));
    }
    void hang(const glm::dmat4& place) {
        entries_.push_back(Create{LampTransform, Transform{.matrix = place, .children = {Lamp}}});
        root_.children.push_back(LampTransform);
    }

    std::shared_ptr<BlobStore> blobs_ = std::make_shared<BlobStore>();
    DeviceHandle device_ = make_device({.threads = 1, .blobs = blobs_});
    Root root_;
    Geometry ground_;
    std::vector<Entry> entries_;
};

constexpr double Threshold = 4.0;  // standard errors, for a dozen tests
constexpr double Rounding = 1e-5;

void expect_value(const Stage::Estimate& estimate, double expected) {
    EXPECT_LE(estimate.standard_error, 0.003 * expected);
    EXPECT_NEAR(estimate.mean, expected, Threshold * estimate.standard_error + Rounding * expected);
}

// Irradiance at the point below the center of a parallel square (four corner form factors).
double square_form_factor(double half_edge, double height) {
    const double x = half_edge / height, r = std::sqrt(1.0 + x * x);
    return 4.0 / (2.0 * Pi) * 2.0 * (x / r) * std::atan(x / r);
}

TEST(DirectLight, PointAboveAPlane) {
    Stage stage;
    stage.add_light({.kind = LightKind::Point, .intensity = glm::vec3(50.0f)}, 2.0);
    expect_value(stage.radiance(Strategy::Both, 4), Albedo / Pi * 50.0 / 4.0);
}

TEST(DirectLight, SpotAboveAPlane) {
    Stage stage;
    stage.add_light({.kind = LightKind::Spot,
                     .intensity = glm::vec3(50.0f),
                     .inner_cone_angle = 0.2f,
                     .outer_cone_angle = 0.4f},
                    2.0);
    expect_value(stage.radiance(Strategy::Both, 4), Albedo / Pi * 50.0 / 4.0);
}

TEST(DirectLight, DirectionalOnAPlane) {
    Stage stage;
    stage.add_light({.kind = LightKind::Directional, .intensity = glm::vec3(3.0f)}, 2.0);
    expect_value(stage.radiance(Strategy::Both, 4), Albedo / Pi * 3.0);
}

TEST(DirectLight, ConstantSkyOverAPlane) {
    for (const Strategy strategy : {Strategy::Both, Strategy::LightsOnly, Strategy::BsdfOnly}) {
        Stage stage;
        stage.add_sky(2.0f);
        expect_value(stage.radiance(strategy, 2048), Albedo * 2.0);
    }
}

class SquareAboveAPlane : public testing::TestWithParam<float> {};

TEST_P(SquareAboveAPlane, AgreesWithItsFormFactorByAllStrategies) {
    for (const Strategy strategy : {Strategy::Both, Strategy::LightsOnly, Strategy::BsdfOnly}) {
        Stage stage;
        stage.add_square(GetParam(), 2.0, 10.0f);
        expect_value(stage.radiance(strategy, 8192),
                     Albedo * 10.0 * square_form_factor(double(GetParam()), 2.0));
    }
}

INSTANTIATE_TEST_SUITE_P(HalfEdges, SquareAboveAPlane, testing::Values(0.5f, 2.0f, 5.0f));

}  // namespace
}  // namespace tessera::embree
