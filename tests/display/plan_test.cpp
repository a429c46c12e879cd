#include "client/tools/display/plan.h"

#include <gtest/gtest.h>

#include "client/tools/display/display_table.h"

namespace tessera::tools {

namespace {

display_file::DisplayFile room(const std::string& metres) {
    scene::BlobStore blobs;
    return display_file::parse_display("[[wall]]\nname = 'w'\nlower_left = [-" + metres + ", -" + metres +
                                           ", -" + metres + "]\nlower_right = [" + metres + ", -" + metres +
                                           ", -" + metres + "]\nupper_left = [-" + metres + ", " + metres +
                                           ", -" + metres + "]\ncolumns = 2\nstereo = 'separate'\n",
                                       "a&b.toml", blobs);
}

TEST(Plan, DrawsEveryOutputOnThePage) {
    for (const char* metres : {"0.001", "1.5", "5000"}) {
        const Drawing drawing = plan(room(metres));
        for (const char* name : {"w-1-1", "w-2-1"}) {
            // A wall of two millimetres next to a head is too small for names.
            const auto least = std::string_view(metres) == "0.001" ? 0 : 2;
            EXPECT_GE(std::ranges::count(drawing.words, name, &Words::text), least) << metres;
        }
        std::size_t areas = 0;
        for (const Path& path : drawing.paths) {
            areas += path.area > 0.0 && path.points.size() > 40;
            for (const glm::dvec2& point : path.points) {
                EXPECT_TRUE(point.x >= 0 && point.y >= 0 && point.x <= drawing.width &&
                            point.y <= drawing.height)
                    << metres << ": " << point.x << " " << point.y;
            }
        }
        EXPECT_EQ(areas, 6u);  // two outputs in three views
    }
}

TEST(Plan, WallIsDrawnAtItsMeasuredPosition) {
    const Drawing drawing = plan(room("1.5"));
    // From the front the left output is a square left of the right one, from above both are one line.
    std::vector<glm::dvec4> boxes;
    for (const Path& path : drawing.paths) {
        if (!(path.area > 0.0 && path.points.size() > 40)) continue;
        glm::dvec2 least = path.points[0], most = least;
        for (const glm::dvec2& point : path.points) {
            least = glm::min(least, point);
            most = glm::max(most, point);
        }
        boxes.emplace_back(least, most);
    }
    ASSERT_EQ(boxes.size(), 6u);
    EXPECT_NEAR(boxes[0].w - boxes[0].y, 0.0, 1e-9);
    EXPECT_NEAR(boxes[0].z, boxes[1].x, 1e-9);
    EXPECT_GT(boxes[0].z - boxes[0].x, 50.0);
    EXPECT_NEAR(boxes[2].w - boxes[2].y, 2.0 * (boxes[2].z - boxes[2].x), 1e-9);
    EXPECT_NEAR(boxes[2].z, boxes[3].x, 1e-9);
}

TEST(Plan, WritesSvgAndPng) {
    const Drawing drawing = plan(room("2"));
    const std::string svg = as_svg(drawing);
    EXPECT_TRUE(svg.starts_with("<svg "));
    EXPECT_TRUE(svg.ends_with("</svg>\n"));
    EXPECT_NE(svg.find(">w-2-1</text>"), std::string::npos);
    EXPECT_NE(svg.find("a&amp;b"), std::string::npos);
    const Canvas canvas = as_canvas(drawing);
    EXPECT_EQ(canvas.rgb.size(), std::size_t{3} * drawing.width * drawing.height);
    EXPECT_GT(std::ranges::count_if(canvas.rgb, [](std::uint8_t value) { return value < 255; }), 10000);
}

TEST(Plan, CanvasClipsShapes) {
    Canvas canvas(20, 10, 255);
    draw_line(canvas, {-1e9, -1e9}, {1e9, 1e9}, 3.0, {0, 0, 0});
    const std::vector<glm::dvec2> large{{-1e12, -5}, {1e12, -5}, {1e12, 5}, {-1e12, 5}};
    fill_polygon(canvas, large, {0, 0, 0}, 1.0);
    draw_text(canvas, -7, -3, 2, "MM");
    EXPECT_EQ(canvas.rgb[3 * (4 * 20 + 3)], 0);
    EXPECT_EQ(canvas.rgb[3 * (6 * 20 + 15)], 255);
}

TEST(DisplayTable, SumsPixelsAndBytesPerFrame) {
    const std::string table = as_table(room("2").display);
    // Two outputs, two eyes each, 1920 x 1080 pixels of three bytes.
    EXPECT_NE(table.find("2 outputs, 4 views, 8.29 megapixels and 24.88 MB a frame"), std::string::npos)
        << table;
    EXPECT_NE(table.find("w-2-1"), std::string::npos);
}

}  // namespace

}  // namespace tessera::tools
