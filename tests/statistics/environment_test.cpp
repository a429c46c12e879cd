// Which way an environment map is turned.
#include "mediator/shading/environment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

// A map of four columns of 1, 2, 3 and 4, from left to right.
struct FourSides : Model {
    FourSides(scene::MapCenter center, float rotation) {
        std::vector<glm::vec3> texels;
        for (int row = 0; row < 2; ++row) {
            for (const float value : {1.0f, 2.0f, 3.0f, 4.0f}) texels.emplace_back(value);
        }
        const scene::Texture map{.width = 4, .height = 2, .format = scene::TexelFormat::RgbFloat};
        sky(scene::Background{
            .environment = texture(map, texels).texture, .rotation = rotation, .map_center = center});
    }
};

// What the camera sees towards each of these.
constexpr glm::dvec3 Diagonals[]{{1, 0, 1}, {-1, 0, 1}, {-1, 0, -1}, {1, 0, -1}};

void expect_sides(scene::MapCenter center, float rotation, const std::array<double, 4>& expected) {
    FourSides sides(center, rotation);
    const SceneAdapter& world = sides.build();
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::dmat4 turn = glm::inverse(glm::lookAt(glm::dvec3(0.0), Diagonals[i], {0.0, 1.0, 0.0}));
        EXPECT_NEAR(mean_of(world, small_view({}, 1e-4, 1, turn), 1, red).value, expected[i], 1e-3) << i;
    }
}

// As in glTF viewers, three.js and Blender: the middle is +x, and u grows towards +z.
TEST(EnvironmentMap, HasItsMiddleInPlusX) {
    expect_sides(scene::MapCenter::PositiveX, 0.0f, {3.0, 4.0, 1.0, 2.0});
}

// As in files of older versions: the middle is -z, and u grows towards +x.
TEST(EnvironmentMap, OfOlderFilesHasItsMiddleInMinusZ) {
    expect_sides(scene::MapCenter::NegativeZ, 0.0f, {4.0, 1.0, 2.0, 3.0});
}

// Seen from above, +x turns towards -z.
TEST(EnvironmentMap, TurnsCounterClockwise) {
    expect_sides(scene::MapCenter::PositiveX, static_cast<float>(0.5 * M_PI), {4.0, 1.0, 2.0, 3.0});
    expect_sides(scene::MapCenter::PositiveX, static_cast<float>(-1.5 * M_PI), {4.0, 1.0, 2.0, 3.0});
}

}  // namespace
}  // namespace tessera::embree
