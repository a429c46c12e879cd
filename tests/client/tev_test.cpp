#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "client/tools/tev/viewer.h"
#include "mediator/base/error.h"
#include "tests/support/fake_tev.h"

namespace tessera::tools::tev {
namespace {

using test::FakeTev;

std::string text_of(const Packet& packet) {
    return {reinterpret_cast<const char*>(packet.data()), packet.size()};
}

// Byte by byte, as tev documents them.
TEST(TevPackets, Create) {
    const std::vector<std::string> channels{"R", "depth.Z"};
    const std::string expected(
        "\x1e\0\0\0"
        "\4"
        "\1"
        "a\0"
        "\2\0\0\0"
        "\3\0\0\0"
        "\2\0\0\0"
        "R\0"
        "depth.Z\0",
        30);
    EXPECT_EQ(text_of(create_image("a", 2, 3, channels)), expected);
}

TEST(TevPackets, Update) {
    const std::vector<std::string> channels{"R", "G"};
    const std::string expected(
        "\x50\0\0\0"
        "\6"
        "\0"
        "a\0"
        "\2\0\0\0"
        "R\0"
        "G\0"
        "\5\0\0\0"
        "\6\0\0\0"
        "\1\0\0\0"
        "\2\0\0\0"
        "\0\0\0\0\0\0\0\0"
        "\2\0\0\0\0\0\0\0"
        "\1\0\0\0\0\0\0\0"
        "\1\0\0\0\0\0\0\0"
        "\0\0\x80\x3f"
        "\0\0\0\x40"
        "\0\0\x40\x40"
        "\0\0\x80\x40",
        80);
    EXPECT_EQ(text_of(update_image("a", channels, {5, 6, 1, 2}, std::vector<float>{1.0f, 2.0f, 3.0f, 4.0f})),
              expected);
}

// 100x70 pixels: four tiles.
std::vector<picture::Layer> layers() {
    picture::Layer color{"", {"R", "G", "B"}, frame::Image(100, 70, 3)};
    for (std::size_t i = 0; i < color.image.values.size(); ++i) color.image.values[i] = 1.0f + float(i);
    picture::Layer depth{"depth", {"Z"}, frame::Image(100, 70, 1)};
    depth.image.values[3] = std::numeric_limits<float>::infinity();
    picture::Layer counts{"samples", {"count"}, frame::Image(100, 70, 1), true};
    for (float& value : counts.image.values) value = std::bit_cast<float>(17u);
    return {color, depth, counts};
}

TEST(TevViewer, ShowsAllLayers) {
    FakeTev tev;
    Viewer viewer(tev.address(), "picture");
    EXPECT_FALSE(viewer.show(layers()));
    tev.read(1 + 4);
    EXPECT_EQ(tev.name, "picture");
    EXPECT_EQ(tev.width, 100);
    EXPECT_EQ(tev.height, 70);
    EXPECT_EQ(tev.channels, (std::vector<std::string>{"R", "G", "B", "depth.Z", "samples.count"}));
    for (std::size_t i = 0; i < 100 * 70; ++i) {
        EXPECT_EQ(tev.planes["R"][i], 1.0f + float(3 * i));
        EXPECT_EQ(tev.planes["B"][i], 3.0f + float(3 * i));
        EXPECT_EQ(tev.planes["samples.count"][i], 17.0f);
    }
    EXPECT_EQ(tev.planes["depth.Z"][3], std::numeric_limits<float>::infinity());
    EXPECT_EQ(tev.planes["depth.Z"][4], 0.0f);
}

TEST(TevViewer, SendsTilesThatHaveChanged) {
    FakeTev tev;
    Viewer viewer(tev.address(), "picture");
    std::vector<picture::Layer> picture = layers();
    viewer.show(picture);
    viewer.show(picture);  // nothing
    picture[1].image.values[69 * 100 + 99] = 5.0f;
    viewer.show(picture);
    tev.read(1 + 4 + 1);
    EXPECT_EQ(tev.created, 1);
    EXPECT_EQ(tev.updated, 5);
    EXPECT_EQ(tev.planes["depth.Z"].back(), 5.0f);
    // Other channels: a new picture.
    picture.pop_back();
    viewer.show(picture);
    tev.read(1 + 4);
    EXPECT_EQ(tev.created, 2);
    EXPECT_EQ(tev.channels.size(), 4u);
}

TEST(TevViewer, ReportsOnceThatTheViewerHasGone) {
    FakeTev tev;
    Viewer viewer(tev.address(), "picture");
    std::vector<picture::Layer> picture = layers();
    EXPECT_FALSE(viewer.show(picture));
    tev.read(1 + 4);
    tev.hang_up();
    int reports = 0;
    for (int i = 0; i < 50; ++i) {
        picture[0].image.values[0] += 1.0f;
        if (const auto problem = viewer.show(picture)) {
            ++reports;
            EXPECT_NE(problem->find("tev at " + tev.address()), std::string::npos) << *problem;
        }
    }
    EXPECT_EQ(reports, 1);
}

TEST(TevViewer, NamesWhatIsWrongWithAnAddress) {
    for (const char* address :
         {"", ":1", "host:", "host:port", "host:123456", "[::1", "[::1]14158", "a:1:2"}) {
        try {
            Viewer viewer(address, "picture");
            FAIL() << address;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::InvalidInput) << address;
            EXPECT_NE(std::string(error.what()).find("'" + std::string(address) + "'"), std::string::npos);
        }
    }
    try {
        Viewer viewer("127.0.0.1:1", "picture");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::Unavailable);
        EXPECT_NE(std::string(error.what()).find("127.0.0.1:1"), std::string::npos);
    }
}

}  // namespace
}  // namespace tessera::tools::tev
