// Viewer preview: what a viewer sees of the outputs' pictures, the inverse of the display's geometry.
#include "client/display_file/viewer_preview.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "mediator/picture/png_writer.h"
#include "mediator/scene/blob.h"

namespace tessera::display_file {
namespace {

class ViewerPreviewTest : public testing::Test {
  protected:
    ViewerPreviewTest() {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ =
            std::filesystem::temp_directory_path() / (std::string("tessera-viewer-preview-") + test->name());
        std::filesystem::create_directories(folder_);
    }
    ~ViewerPreviewTest() override { std::filesystem::remove_all(folder_); }

    void put(const std::string& name, std::uint32_t width, std::uint32_t height,
             std::array<std::uint8_t, 3> rgb) {
        std::vector<std::uint8_t> bytes;
        for (std::uint32_t i = 0; i < width * height; ++i) bytes.insert(bytes.end(), rgb.begin(), rgb.end());
        picture::write_png((folder_ / name).string(), width, height, bytes);
    }
    std::vector<ScreenPicture> preview(const std::string& text, const ViewerPreviewOptions& options) {
        scene::BlobStore blobs;
        tbb::task_arena arena(2);
        return simulate_viewer(parse_display(text, "wall.toml", blobs), folder_.string(), options, arena);
    }

    std::filesystem::path folder_;
};

constexpr const char* Wall = R"(
[[wall]]
name = "w"
lower_left = [-2, -0.5, -2]
lower_right = [2, -0.5, -2]
upper_left = [-2, 0.5, -2]
columns = 2
size = [200, 100]
)";

float red_at(const ScreenPicture& picture, std::uint32_t x, std::uint32_t y) {
    return picture.light.pixel(std::size_t{y} * picture.light.width + x)[0];
}

TEST_F(ViewerPreviewTest, OutputsOfAWallAreSideBySide) {
    put("w-1-1.png", 200, 100, {255, 0, 0});
    put("w-2-1.png", 200, 100, {0, 255, 0});
    const auto pictures = preview(Wall, {.width = 400});
    ASSERT_EQ(pictures.size(), 1u);
    EXPECT_EQ(pictures[0].screen, "w");
    EXPECT_EQ(pictures[0].light.height, 100u);
    EXPECT_FLOAT_EQ(red_at(pictures[0], 10, 50), 1.0f);
    EXPECT_FLOAT_EQ(red_at(pictures[0], 199, 99), 1.0f);
    EXPECT_FLOAT_EQ(red_at(pictures[0], 200, 0), 0.0f);
    EXPECT_FLOAT_EQ(pictures[0].light.pixel(399)[1], 1.0f);
}

TEST_F(ViewerPreviewTest, OverlapsAndBlackAddUpInLinearLight) {
    put("w-1-1.png", 200, 100, {188, 0, 0});
    put("w-2-1.png", 200, 100, {188, 0, 0});
    const auto pictures = preview(std::string(Wall) + "overlap = [40, 0]\n", {.width = 360, .black = 0.01});
    const float half = 0.01f + 0.99f * 0.5028865f;
    EXPECT_NEAR(red_at(pictures[0], 20, 50), half, 1e-3);
    EXPECT_NEAR(red_at(pictures[0], 180, 50), 2 * half, 1e-3);
    EXPECT_NEAR(pictures[0].light.pixel(50 * 360 + 180)[2], 0.02, 1e-4);
}

TEST_F(ViewerPreviewTest, EyesSeeTheirOwnPictures) {
    const std::string one = "[[output]]\nname = \"o\"\nsize = [64, 64]\n";
    put("o-left.png", 64, 64, {255, 0, 0});
    put("o-right.png", 64, 64, {0, 0, 255});
    const auto apart = preview(one + "stereo = \"separate\"\n", {.width = 32});
    ASSERT_EQ(apart.size(), 2u);
    EXPECT_EQ(apart[0].eye, view::Eye::Left);
    EXPECT_FLOAT_EQ(red_at(apart[0], 16, 16), 1.0f);
    EXPECT_FLOAT_EQ(red_at(apart[1], 16, 16), 0.0f);

    std::vector<std::uint8_t> halves;
    for (int i = 0; i < 64 * 64; ++i)
        for (int c = 0; c < 3; ++c) halves.push_back(i % 64 < 32 && c == 0 ? 255 : 0);
    picture::write_png((folder_ / "o.png").string(), 64, 64, halves);
    const auto packed = preview(one + "stereo = \"side-by-side\"\n", {.width = 32});
    ASSERT_EQ(packed.size(), 2u);
    for (std::uint32_t x = 0; x < 32; ++x) {
        EXPECT_FLOAT_EQ(red_at(packed[0], x, 10), 1.0f) << x;
        EXPECT_FLOAT_EQ(red_at(packed[1], x, 10), 0.0f) << x;
    }
}

TEST_F(ViewerPreviewTest, ErrorsNameTheMissingOrMismatchedPicture) {
    const auto message = [&] {
        try {
            preview(Wall, {});
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_NE(message().find("w-1-1.png' does not exist"), std::string::npos);
    put("w-1-1.png", 100, 100, {1, 2, 3});
    EXPECT_NE(message().find("200 x 100 pixels, the size of output 'w-1-1'"), std::string::npos);
}

}  // namespace
}  // namespace tessera::display_file
