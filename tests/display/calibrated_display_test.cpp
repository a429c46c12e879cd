// Displays whose outputs name files of calibration tools.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>

#include "client/display_file/display_file.h"
#include "mediator/display/frustum.h"
#include "mediator/picture/png_writer.h"
#include "tests/display/camera_math.h"

namespace tessera::display_file {

namespace {

constexpr float Nothing = std::numeric_limits<float>::quiet_NaN();
constexpr std::uint32_t Width = 64, Height = 40;

class CalibratedDisplay : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() /
                  ("tessera-calibrated-" + std::to_string(::getpid()) + "-" +
                   testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    void write(const std::string& name, const std::string& bytes) {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
    }
    template <class At>  // three floats at (u, v)
    void write_pfm(const std::string& name, const At& at) {
        std::string bytes = "PF\n" + std::to_string(Width) + " " + std::to_string(Height) + "\n-1\n";
        for (std::uint32_t y = 0; y < Height; ++y) {
            for (std::uint32_t x = 0; x < Width; ++x) {
                const glm::vec3 value = at((x + 0.5) / Width, (y + 0.5) / Height);
                bytes.append(reinterpret_cast<const char*>(&value.x), 12);
            }
        }
        write(name, bytes);
    }
    DisplayFile read(const std::string& text) {
        write("wall.toml", text);
        return read_display((folder_ / "wall.toml").string(), blobs_);
    }
    std::span<const float> values(const display::Grid& grid) {
        return blobs_.find(grid.values.hash)->as<float>();
    }
    std::string refusal(const std::string& text) {
        try {
            read(text);
        } catch (const Error& error) {
            return error.what();
        }
        return "taken";
    }

    std::filesystem::path folder_;
    scene::BlobStore blobs_;
};

const std::string Output = "[[output]]\nname = 'a'\nsize = [64, 40]\n";
const std::string Flat =
    Output + "lower_left = [-1, -1, -2]\nlower_right = [1, -1, -2]\nupper_left = [-1, 1, -2]\n";

TEST_F(CalibratedDisplay, EveryPixelOfADomeFromPointsIsAccurate) {
    // A zone of a sphere of three metres; pixels beyond a circle are masked.
    const auto dome = [](double u, double v) {
        const double azimuth = (u - 0.5) * 1.2, elevation = 0.9 - 0.8 * v;
        if (std::hypot(u - 0.5, v - 0.5) > 0.6) return glm::vec3(Nothing);
        return glm::vec3(3.0 * std::cos(elevation) * std::sin(azimuth), 3.0 * std::sin(elevation),
                         -3.0 * std::cos(elevation) * std::cos(azimuth));
    };
    write_pfm("dome.pfm", dome);
    const DisplayFile file = read(Output + "points = 'dome.pfm'\n[head]\nposition = [0.1, 0.2, 0.3]\n");
    const display::Output& output = file.display.outputs.at(0);
    EXPECT_EQ(output.points.nodes, display::Grid::Nodes::Centres);
    EXPECT_EQ(output.points.columns, Width);
    EXPECT_FALSE(file.geometry[0].surface);
    const auto points = values(output.points);
    const view::CameraPose camera =
        display::frustum(output.plane, file.display.head, view::Eye::Mono, 0.064, 0.0);
    int seen = 0;
    for (std::uint32_t i = 0; i < Width * Height; ++i) {
        const glm::dvec3 point(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
        const glm::dvec3 known = dome((i % Width + 0.5) / Width, (i / Width + 0.5) / Height);
        ASSERT_EQ(std::isnan(known.x), std::isnan(point.x));
        if (std::isnan(known.x)) continue;
        ++seen;
        const glm::dvec2 position = display::image_position(camera, point);
        EXPECT_TRUE(position.x > -1e-9 && position.x < 1 + 1e-9 && position.y > -1e-9 &&
                    position.y < 1 + 1e-9);
        const glm::dvec3 direction = known - glm::dvec3(camera.world_from_camera[3]);
        EXPECT_LT(glm::length(glm::cross(display::direction_through(camera, position), direction)), 1e-6);
    }
    EXPECT_GT(seen, 2000);
}

TEST_F(CalibratedDisplay, WarpDistortsThePictureOnItsWall) {
    write_pfm("warp.pfm", [](double u, double v) { return glm::vec3(0.1 + 0.8 * u, v, 0.0); });
    const DisplayFile file = read(Flat + "warp = 'warp.pfm'\n");
    const auto points = values(file.display.outputs.at(0).points);
    EXPECT_NEAR(points[0], -1.0 + 2.0 * (0.1 + 0.8 * 0.5 / Width), 1e-6);
    EXPECT_NEAR(points[1], 1.0 - 2.0 * 0.5 / Height, 1e-6);
    EXPECT_EQ(points[2], -2.0f);
    EXPECT_EQ(file.display.outputs[0].plane.origin, glm::dvec3(-1, -1, -2));
}

TEST_F(CalibratedDisplay, MeshBrightnessBecomesWeights) {
    write("warp.data", "2\n2 2\n-1.6 -1 0 0 1\n1.6 -1 1 0 0.5\n-1.6 1 0 1 1\n1.6 1 1 1 0.5\n");
    const DisplayFile file = read(Flat + "warp = 'warp.data'\n");
    const display::Output& output = file.display.outputs.at(0);
    const auto points = values(output.points), weights = values(output.blend.weights);
    EXPECT_NEAR(points[0], -1.0 + 2.0 * 0.5 / Width, 1e-5);
    EXPECT_NEAR(points[1], 1.0 - 2.0 * 0.5 / Height, 1e-5);
    EXPECT_NEAR(weights[0], 1.0f, 0.01f);
    EXPECT_NEAR(weights[Width - 1], 0.5f, 0.01f);
}

TEST_F(CalibratedDisplay, WeightsAndLiftAreLinear) {
    const std::vector<std::uint8_t> rgb(2 * 2 * 3, 51);
    picture::write_png((folder_ / "w.png").string(), 2, 2, rgb);
    const DisplayFile file = read(Flat + "weights = 'w.png'\nlift = 'w.png'\n");
    const display::Blend& blend = file.display.outputs.at(0).blend;
    EXPECT_NEAR(values(blend.weights)[0], 0.2f, 1e-6f);
    EXPECT_NEAR(values(blend.lift)[1], 0.2f, 1e-6f);
    EXPECT_EQ(blend.weights.columns, 2u);
}

TEST_F(CalibratedDisplay, ErrorsAreReportedAtTheirKey) {
    write("bad.pfm", "PF\n2 2\n-1\nxx");
    write("grey.pfm", "Pf\n1 1\n-1\nxxxx");
    const std::string file = (folder_ / "wall.toml").string();
    const auto expect = [&](const std::string& text, const std::string& position, const std::string& says) {
        const std::string said = refusal(text);
        EXPECT_TRUE(said.starts_with(file + position)) << said;
        EXPECT_NE(said.find(says), std::string::npos) << said;
    };
    expect(Flat + "warp = 'no.pfm'\n", ":7:1: output 'a': ", "no.pfm");
    expect(Flat + "warp = 'no.data'\n", ":7:1: output 'a': ", "no.data");
    expect(Flat + "weights = 'no.png'\n", ":7:1: output 'a': ", "no.png");
    expect(Flat + "warp = 'bad.pfm'\n", ":7:1: output 'a': ", "bad.pfm");
    expect(Flat + "warp = 'grey.pfm'\n", ":7:1: output 'a': ", "one component");
    expect(Flat + "points = 'bad.pfm'\n", ":7:1: output 'a': ", "where the screen is");
    expect(Flat + "points = 'a'\nwarp = 'b'\n", ":1:", "several of");
    expect(Output + "points = ''\n", ":4:1: output 'a': ", "");
    write_pfm("line.pfm", [](double u, double) { return glm::vec3(u, 0.0, -1.0); });
    expect(Output + "points = 'line.pfm'\n", ":1:", "do not form a surface");
    write_pfm("behind.pfm", [](double u, double v) { return glm::vec3(u, -v, -1.0); });
    expect(Output + "turn = 90\npoints = 'behind.pfm'\n", ":4:1: output 'a': ", "leave 'turn' out");
}

}  // namespace

}  // namespace tessera::display_file
