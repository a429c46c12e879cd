// Parsing of option values, valid and invalid.
#include "client/tools/values.h"

#include <gtest/gtest.h>

namespace tessera::tools {
namespace {

TEST(Values, Sizes) {
    EXPECT_EQ(parse_size("1280x720")->width, 1280u);
    EXPECT_EQ(parse_size("1x65536")->height, 65536u);
    for (const char* text : {"", "x", "1280", "0x5", "5x0", "65537x1", "-1x5", "1e3x5", "12x12x12", "12 x 12",
                             "4294967297x1", "99999999999999999999x1"}) {
        EXPECT_FALSE(parse_size(text)) << text;
    }
}

TEST(Values, LayersAreAMask) {
    EXPECT_EQ(*parse_layers("0"), 1u);
    EXPECT_EQ(*parse_layers("0,2,31"), 0x80000005u);
    for (const char* text : {"", "32", "-1", "1,", ",1", "1 2", "0x1", "all", "4294967296"}) {
        EXPECT_FALSE(parse_layers(text)) << text;
    }
}

TEST(Values, CropsMustBeInsideThePicture) {
    const Size picture{100, 50};
    EXPECT_EQ(*parse_crop("10,20,30,30", picture), (Rect{10, 20, 30, 30}));
    EXPECT_EQ(*parse_crop("0,0,100,50", picture), (Rect{0, 0, 100, 50}));
    for (const char* text : {"0,0,101,50", "0,1,100,50", "-1,0,5,5", "0,0,0,5", "0,0,5", "0,0,5,5,5",
                             "a,0,5,5", "99,49,2147483647,1", "2147483647,0,1,1"}) {
        EXPECT_FALSE(parse_crop(text, picture)) << text;
    }
}

TEST(Values, ColoursAreFiniteAndNotNegative) {
    EXPECT_EQ(*parse_color("0.5,1,2"), glm::vec3(0.5f, 1.0f, 2.0f));
    EXPECT_EQ(*parse_color("1e-3"), glm::vec3(1e-3f));
    for (const char* text :
         {"", "1,2", "1,2,3,4", "nan,0,0", "inf,0,0", "-0.1,0,0", "1,,1", "1e99,0,0", "red"}) {
        EXPECT_FALSE(parse_color(text)) << text;
    }
}

TEST(Values, DurationsHaveAUnit) {
    EXPECT_EQ(*parse_duration("800ms"), std::chrono::milliseconds(800));
    EXPECT_EQ(*parse_duration("2.5s"), std::chrono::milliseconds(2500));
    EXPECT_EQ(*parse_duration("3m"), std::chrono::minutes(3));
    EXPECT_EQ(*parse_duration("1h"), std::chrono::hours(1));
    for (const char* text :
         {"", "800", "ms", "0s", "-1s", "1.2.3s", "5 s", "5days", "1000h", "0.0001ms", "nans"}) {
        EXPECT_FALSE(parse_duration(text)) << text;
    }
}

TEST(Values, NodesToWaitFor) {
    EXPECT_EQ(parse_node_wait("3")->nodes, 3u);
    EXPECT_EQ(parse_node_wait("3")->limit, std::chrono::seconds(60));
    EXPECT_EQ(parse_node_wait("2:0.5")->limit, std::chrono::milliseconds(500));
    for (const char* text : {"", "0", "-1", "2:", "2:x", "2:-1", "2:3:4", ":5", "2:nan", "2:1e30"}) {
        EXPECT_FALSE(parse_node_wait(text)) << text;
    }
}

TEST(Values, PixelsMustBeInsideThePicture) {
    EXPECT_EQ(parse_pixel("99,49", {100, 50})->y, 49u);
    for (const char* text : {"100,0", "0,50", "-1,0", "5", "5,5,5", ""}) {
        EXPECT_FALSE(parse_pixel(text, {100, 50})) << text;
    }
}

TEST(Values, ErrorsQuoteTheTextAndShowAValidOne) {
    const std::string message = parse_duration("800").error().what();
    EXPECT_NE(message.find("'800'"), std::string::npos) << message;
    EXPECT_NE(message.find("800ms"), std::string::npos) << message;
}

}  // namespace
}  // namespace tessera::tools
