// Cameras that frame everything.
#include "client/import/framing.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

namespace tessera::import {
namespace {

// Extent of the projected corners of a box; both picture axes are -1 to 1.
struct Seen {
    glm::dvec2 lower{1e30}, upper{-1e30};
    double nearest = 1e30;  // along the axis

    Seen(const Bounds& box, const glm::dmat4& world_from_camera, double vertical_fov, double aspect_ratio) {
        const glm::dmat4 camera_from_world = glm::inverse(world_from_camera);
        const double top = std::tan(0.5 * vertical_fov);
        for (const double x : {box.lower.x, box.upper.x}) {
            for (const double y : {box.lower.y, box.upper.y}) {
                for (const double z : {box.lower.z, box.upper.z}) {
                    const glm::dvec3 position(camera_from_world * glm::dvec4(x, y, z, 1.0));
                    const glm::dvec2 at =
                        glm::dvec2(position.x / aspect_ratio, position.y) / (-position.z * top);
                    nearest = std::min(nearest, -position.z);
                    lower = glm::min(lower, at);
                    upper = glm::max(upper, at);
                }
            }
        }
    }
};

// Flat boxes of each orientation, long, tall, a cube, a stick, tiny, huge and far away.
const Bounds Boxes[] = {{{-5, 0, -5}, {5, 0, 5}},
                        {{-2, -1, 0}, {2, 1, 0}},
                        {{0, -1, -2}, {0, 1, 2}},
                        {{-50, 0, -1}, {50, 2, 1}},
                        {{-1, 0, -50}, {1, 2, 50}},
                        {{-1, 0, -1}, {1, 80, 1}},
                        {{-1, -1, -1}, {1, 1, 1}},
                        {{0, 0, 0}, {0, 0, 3}},
                        {{1e-6, 1e-6, 1e-6}, {2e-6, 3e-6, 2e-6}},
                        {{-1e9, -1e8, -1e9}, {1e9, 1e8, 1e9}},
                        {{1e6, 1e6, 1e6}, {1e6 + 2, 1e6 + 1, 1e6 + 3}}};

TEST(Framing, IsTightAndShowsEverything) {
    for (const Bounds& box : Boxes) {
        for (const double fov : {0.2, 0.7, 2.0}) {
            for (const double aspect : {0.5, 1.0, 16.0 / 9.0, 4.0}) {
                const Seen seen(box, framing_pose(box, fov, aspect), fov, aspect);
                const glm::dvec2 size = 0.5 * (seen.upper - seen.lower);
                EXPECT_GT(seen.nearest, 0.0);
                if (fov < 1.0 && aspect < 2.0) {
                    EXPECT_GE(std::max(size.x, size.y), 0.9) << box.upper.x << ' ' << aspect;
                    EXPECT_NEAR(std::max(size.x, size.y), 1.0 - 2.0 * FramingMargin, 1e-6);
                }
                for (int k = 0; k < 2; ++k) {
                    EXPECT_NEAR(seen.lower[k], -seen.upper[k], 1e-6) << "centred";
                    EXPECT_GE(seen.lower[k], -1.0) << box.upper.x << ' ' << aspect;
                    EXPECT_LE(seen.upper[k], 1.0) << box.upper.x << ' ' << aspect;
                }
            }
        }
    }
}

TEST(Framing, OfNothingAndOfAPointIsOfABoxAroundIt) {
    const Bounds unit{glm::dvec3(-0.5), glm::dvec3(0.5)}, point{glm::dvec3(7.0), glm::dvec3(7.0)};
    const glm::dmat4 of_unit = framing_pose(unit, 0.7, 1.0);
    EXPECT_EQ(framing_pose({}, 0.7, 1.0), of_unit);
    const glm::dmat4 of_point = framing_pose(point, 0.7, 1.0);
    EXPECT_LT(glm::length(of_point[3] - of_unit[3] - glm::dvec4(7.0, 7.0, 7.0, 0.0)), 1e-12);
}

// The aspect ratio is an option of the importer.
std::string file_of_a_triangle(const std::vector<glm::vec3>& corners) {
    SceneFile file;
    const int at = file.positions(corners);
    file.add("meshes", R"({"primitives":[{"attributes":{"POSITION":)" + std::to_string(at) + "}}]}");
    file.add("nodes", R"({"mesh":0})");
    file.add("scenes", R"({"nodes":[0]})");
    return file.glb();
}

TEST(Framing, ComesWithAFileThatHasNoCamera) {
    const TestFolder folder;
    const auto path = folder.write("scene.glb", file_of_a_triangle({{0, 0, 0}, {30, 0, 0}, {0, 0, -2}}));
    for (const double aspect : {1.0, 2.5}) {
        const ImportedScene scene = loaded(path, {.aspect_ratio = aspect});
        ASSERT_EQ(scene.cameras.size(), 1u);
        const CameraInfo& camera = scene.cameras[0];
        const Seen seen({{0, 0, -2}, {30, 0, 0}}, camera.world_from_camera, camera.camera.vertical_fov,
                        aspect);
        EXPECT_NEAR(0.5 * (seen.upper.x - seen.lower.x), 1.0 - 2.0 * FramingMargin, 1e-6) << aspect;
    }
}

TEST(Framing, OfAHugeSceneStaysWithinWhatASceneMayHave) {
    const TestFolder folder;
    const ImportedScene scene =
        loaded(folder.write("scene.glb", file_of_a_triangle({{0, 0, 0}, {9e14f, 0, 0}, {0, 9e14f, 0}})));
    expect_consistent(scene);
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_THAT(scene.notices, testing::Contains(testing::HasSubstr("within 1e12 m")));
}

}  // namespace
}  // namespace tessera::import
