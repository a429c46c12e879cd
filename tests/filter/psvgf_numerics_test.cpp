// Progressive SVGF at numerical limits: far origins, infinite depth, no samples, grazing planes, huge ranges.
#include <gtest/gtest.h>

#include <cmath>

#include "master/filter/catalog.h"
#include "mediator/base/random.h"
#include "mediator/filter/choice.h"
#include "tests/filter/planes_scene.h"

namespace tessera::filter {
namespace {

constexpr std::uint32_t Width = 96, Height = 64;

class Session {
  public:
    explicit Session(const std::string& choice)
        : choice_(parse_choice("psvgf:" + choice, catalog()).value()), filter_(choice_.entry->make(0, 0)) {
        out_.wants_maps = true;
    }
    const Output& restart(Inputs inputs) {
        inputs.changes.film_restarted = true;
        filter_->run(inputs, choice_.values, out_, {arena_, {}});
        return out_;
    }

  private:
    Choice choice_;
    std::unique_ptr<Filter> filter_;
    tbb::task_arena arena_{2};
    Output out_;
};

bool all_finite(const Planes& planes) {
    return std::ranges::all_of(planes.values(), [](float v) { return std::isfinite(v); });
}

// Two frames with a camera move in between, all stages enabled.
Output moved(const PlanesScene& scene, double scale, const std::string& choice, std::uint64_t n = 2) {
    Session session(choice);
    const glm::dvec3 to = scale * glm::dvec3(0.2, 0.1, -0.3);
    session.restart(photograph(scene, looking_at(scene, {}, Width, Height), {.n = n, .seed = 1}));
    return session.restart(
        photograph(scene, looking_at(scene, to, Width, Height, 0.03), {.n = n, .seed = 2}));
}

TEST(PsvgfNumerics, FarOriginsChangeNothing) {
    PlanesScene near;
    PlanesScene far = near;
    far.origin = {3e7, -2e7, 5e7};
    const Output a = moved(near, 1.0, ""), b = moved(far, 1.0, "");
    // Samples themselves differ where a ray passes an edge or a texture by a rounding of 1e-8.
    double differing = 0.0;
    for (std::size_t i = 0; i < a.picture.values().size(); ++i) {
        differing += std::abs(a.picture.values()[i] - b.picture.values()[i]) > 1e-3 ? 1.0 : 0.0;
    }
    EXPECT_LT(differing, 0.002 * double(a.picture.values().size()));
}

TEST(PsvgfNumerics, TheUnitOfLengthDoesNotMatter) {
    for (const double scale : {1e-6, 1e6}) {
        PlanesScene scene, scaled;
        scene.textured = scaled.textured = false;
        scaled.wall *= scale;
        scaled.board *= scale;
        scaled.board_half *= scale;
        const Output a = moved(scene, 1.0, ""), b = moved(scaled, scale, "");
        double differing = 0.0;
        for (std::size_t i = 0; i < a.picture.values().size(); ++i) {
            differing += std::abs(a.picture.values()[i] - b.picture.values()[i]) > 1e-3 ? 1.0 : 0.0;
        }
        EXPECT_LT(differing, 0.002 * double(a.picture.values().size())) << scale;
    }
}

TEST(PsvgfNumerics, TheUnitOfLightDoesNotMatter) {
    PlanesScene scene;
    const Output plain = moved(scene, 1.0, "taa=off", 4);
    for (const float strength : {1e-12f, 1e12f}) {
        scene.strength = strength;
        const Output scaled = moved(scene, 1.0, "taa=off", 4);
        ASSERT_TRUE(all_finite(scaled.picture));
        for (std::size_t i = 0; i < plain.picture.values().size(); ++i) {
            EXPECT_NEAR(scaled.picture.values()[i] / strength, plain.picture.values()[i], 2e-4);
        }
    }
}

TEST(PsvgfNumerics, GrazingAndInfinitePlanes) {
    for (const double tilt : {3.0, 100.0, 1e5, -1e3}) {
        PlanesScene scene;
        scene.tilt = tilt;
        for (const char* choice :
             {"", "mode=dundr", "mode=svgf,rest=filtered", "steep=0", "sigma_d=0,eps_d=0"}) {
            EXPECT_TRUE(all_finite(moved(scene, 1.0, choice).picture)) << tilt << " " << choice;
        }
    }
    PlanesScene behind;  // nothing in front of the camera at all
    behind.wall = -1.0;
    behind.board_half = 0.0;
    const Output nothing = moved(behind, 1.0, "");
    for (const float v : nothing.picture.values()) EXPECT_EQ(v, 0.0f);
}

TEST(PsvgfNumerics, HugeRangesStayFinite) {
    for (const std::uint64_t n : {1u, 2u, 4u}) {
        Session session("rest=filtered");
        for (std::uint64_t frame = 0; frame < 3; ++frame) {
            Inputs inputs = synthetic_inputs(Width, Height, n, [&](auto x, auto y, auto i) {
                CounterRandom random(7 + frame, (std::uint64_t{y} << 32 | x) ^ mix(i));
                SyntheticSample s = shadowed_texture(Width, Height, x, y, i);
                const auto wild = [&] {
                    return static_cast<float>(std::pow(10.0, 36.0 * random.uniform() - 18.0));
                };
                for (int c = 0; c < 3; ++c) {
                    s.albedo[c] = random.uniform() < 0.2 ? 0.0f : static_cast<float>(random.uniform());
                    s.irradiance[c] = wild();
                    s.high[c] = s.albedo[c] * s.irradiance[c];
                    s.low[c] = wild();
                }
                s.depth = random.uniform() < 0.1 ? std::numeric_limits<float>::infinity() : wild();
                s.object = static_cast<std::uint32_t>(random.below(3));
                if (random.uniform() < 0.1) s.normal = {0.0f, 0.0f, 0.0f};
                return s;
            });
            inputs.path_class = view::PathClass::Diffuse;
            inputs.camera.world_from_camera[3][0] = 0.1 * double(frame);
            const Output& out = session.restart(inputs);
            EXPECT_TRUE(all_finite(out.picture));
            for (const DebugMap& map : out.maps) EXPECT_TRUE(all_finite(map.planes)) << map.name;
        }
    }
}

TEST(PsvgfNumerics, SmallPicturesAndAnyLevels) {
    for (const std::uint32_t width : {1u, 2u, 7u, 33u, 65u}) {
        for (const std::uint32_t height : {1u, 3u, 40u}) {
            PlanesScene scene;
            for (const char* choice : {"levels=7", "levels=1,rest=filtered", "levels=0", "order=coarse"}) {
                Session session(choice);
                for (std::uint64_t frame = 0; frame < 3; ++frame) {
                    const auto camera = looking_at(scene, {0.1 * double(frame), 0.0, 0.0}, width, height);
                    const Output& out = session.restart(photograph(scene, camera,
                                                                   {.width = width,
                                                                    .height = height,
                                                                    .seed = frame,
                                                                    .coverage = frame == 1 ? 0.4 : 1.0}));
                    EXPECT_TRUE(all_finite(out.picture)) << width << "x" << height << " " << choice;
                }
            }
        }
    }
}

TEST(PsvgfNumerics, OneSampleInTheWholePictureFillsIt) {
    PlanesScene scene;
    scene.board_half = 0.0;
    const auto camera = looking_at(scene, {}, Width, Height);
    Inputs inputs = photograph(scene, camera, {.coverage = 0.0, .noise = false});
    const Inputs full = photograph(scene, camera, {.noise = false});
    const std::size_t only = 17 * Width + 40;
    inputs.counts.plane(0)[only] = 1.0f;
    inputs.object_ids[only] = 1;
    for (std::size_t channel = 0; channel < frame::ChannelCount; ++channel) {
        for (std::uint32_t c = 0; c < inputs.means[channel].components(); ++c) {
            inputs.means[channel].plane(c)[only] = full.means[channel].plane(c)[only];
        }
    }
    const Planes picture = Session("").restart(inputs).picture;
    for (const float v : picture.plane(0)) {
        EXPECT_NEAR(v, full.mean(frame::Channel::Radiance).plane(0)[only], 1e-5);
    }
}

TEST(PsvgfNumerics, ManyRestartsDoNotDrift) {
    PlanesScene scene;
    scene.board_half = 0.0;
    scene.textured = false;
    Session session("r0=0");
    Output last;
    for (int frame = 0; frame < 200; ++frame) {
        const double angle = 0.1 * frame;
        const auto camera = looking_at(scene, {0.5 * std::sin(angle), 0.5 * std::cos(angle), 0.0}, Width,
                                       Height, 0.02 * angle);
        last = session.restart(photograph(scene, camera, {.seed = std::uint64_t(frame), .noise = false}));
    }
    const Planes& picture = last.picture;
    for (const float v : picture.plane(0)) EXPECT_NEAR(v, 0.25f, 1e-5);
}

}  // namespace
}  // namespace tessera::filter
