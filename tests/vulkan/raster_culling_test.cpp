// Instances that show nothing are left out, and the picture is the same without that.
#include <random>

#include "tests/vulkan/raster_fixture.h"

namespace tessera::vulkan {
namespace {

using test::moved;

// A crowd of balls, most of them behind a wall, behind the eye or outside of the picture.
class RasterCulling : public RasterTest {
  protected:
    static constexpr std::uint32_t Balls = 400;

    void SetUp() override {
        RasterTest::SetUp();
        std::mt19937 random(6);
        const auto uniform = [&](double low, double high) {
            return low + (high - low) * double(random()) / 4294967296.0;
        };
        wall_ = square(3.0);
        place(wall_, moved(0, 0, -5));
        const ObjectId ball = sphere(0.2, 5);
        for (std::uint32_t i = 0; i < Balls; ++i) {
            place(ball, moved(uniform(-8, 8), uniform(-8, 8), i < 12 ? uniform(-4, -1) : uniform(-30, 20)));
        }
        light({0, 0, 0}, 30.0f);
        build();
    }
    static RasterSettings culled() {
        return {.culling = RasterSettings::Culling::On, .occlusion_min_instances = 1};
    }
    static RasterSettings everything() { return {.culling = RasterSettings::Culling::Off}; }

    ObjectId wall_;
};

TEST_F(RasterCulling, CullsOutsideAndOccludedInstances) {
    const view::View view = view_from({}, 64, 64);
    EXPECT_EQ(drawn(view, view.window, everything(), 0), Balls + 1);
    const std::uint32_t inside = drawn(view, view.window, culled(), 0);  // nothing seen before hides anything
    const std::uint32_t unhidden = drawn(view, view.window, culled(), 2);
    EXPECT_LT(inside, Balls / 2);
    EXPECT_LT(unhidden, inside / 3);
    EXPECT_GT(unhidden, 1u);
    EXPECT_LT(drawn(view, {0, 0, 16, 16}, culled(), 0), inside / 2)
        << "instances outside the tile are culled";
}

// From place to place, with what was seen at the one before in mind.
TEST_F(RasterCulling, DoesNotChangeThePicture) {
    std::mt19937 random(8);
    for (int turn = 0; turn < 10; ++turn) {
        view::View view = view_from({}, 80, 60);
        view.camera.world_from_camera =
            glm::rotate(moved(0.1 * turn, 0, -0.7 * turn), 0.3 * (turn % 5), glm::dvec3(0, 1, 0));
        Rect tile = view.window;
        if (turn % 3 != 0) tile = {std::int32_t(random() % 40), std::int32_t(random() % 30), 33, 21};
        const frame::FilmTile expected = film(view, tile, {0, 2}, everything());
        EXPECT_TRUE(frame::identical_bits(expected, film(view, tile, {0, 2}, culled()))) << turn;
        EXPECT_TRUE(
            frame::identical_bits(expected, film(view, tile, {0, 2}, {.occlusion_min_instances = 100000})))
            << turn;
    }
}

TEST_F(RasterCulling, DrawBatchingDoesNotChangeThePicture) {
    const view::View view = view_from({}, 64, 48);
    const frame::FilmTile expected = film(view, {0, 1}, everything());
    for (const std::uint32_t per_call : {1u, 7u}) {
        RasterSettings settings = culled();
        settings.draws_per_call = per_call;
        EXPECT_TRUE(frame::identical_bits(expected, film(view, {0, 1}, settings))) << per_call;
    }
}

// Boxes around the eye, across its plane, thinner than a pixel, and at large distances.
TEST_F(RasterTest, BoxesAroundOrBehindTheEyeAreNotCulled) {
    place(sphere(500.0, 6), moved(0, 0, 0));
    place(square(1000.0), glm::rotate(moved(0, -1, 0), 1.5707963, glm::dvec3(1, 0, 0)));
    place(sphere(0.001, 4), moved(0.01, 0, -0.5));
    place(square(1e-5), moved(0, 0, -1e-4));
    place(sphere(0.3, 6), moved(0.2, 0.1, 0.1));
    for (int i = 0; i < 40; ++i) place(square(0.4), moved(i % 7 - 3.0, 0.4, -2.0 - i));
    build();
    for (const double turn : {0.0, 1.0, 2.0, 4.0}) {
        view::View view = view_from({}, 64, 48);
        view.camera.world_from_camera = glm::rotate(glm::dmat4(1.0), turn, glm::dvec3(0.2, 1, 0.1));
        const frame::FilmTile expected = film(view, {0, 2}, {.culling = RasterSettings::Culling::Off});
        EXPECT_TRUE(frame::identical_bits(expected, film(view, {0, 2}, {.occlusion_min_instances = 1})))
            << turn;
    }
}

}  // namespace
}  // namespace tessera::vulkan
