#include "client/tools/display/head_packet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tessera::tools {
namespace {

std::string problem(std::string_view packet) {
    const auto head = parse_head(packet);
    return head ? "" : head.error().what();
}

TEST(HeadPacket, ParsesPositions) {
    for (const char* text : {"0.25 1.75 -0.5", "head 0.25 1.75 -0.5", "  0.25\t+1.75  -5e-1 ",
                             "0.25 1.75 -.5\n", "head .25 1.75 -0.5\r\n"}) {
        const auto head = parse_head(text);
        ASSERT_TRUE(head) << text << ": " << head.error().what();
        EXPECT_EQ(*head, (display::Head{.position = {0.25, 1.75, -0.5}})) << text;
    }
}

TEST(HeadPacket, QuaternionStartsWithItsRealPart) {
    const auto head = parse_head("head 1 2 3 0 0 1 0");
    ASSERT_TRUE(head);
    EXPECT_EQ(head->position, glm::dvec3(1, 2, 3));
    const glm::dvec3 right = head->orientation * glm::dvec3(1, 0, 0);  // half a turn about y
    EXPECT_NEAR(right.x, -1.0, 1e-15);
}

TEST(HeadPacket, QuaternionsAreNormalized) {
    for (const char* turn : {"4e-324 0 4e-324 0", "1e-200 0 1e-200 0", "0.001 0 0.001 0", "3 0 3 0",
                             "1e308 0 1e308 0", "1.7e308 0 1.7e308 0"}) {
        const auto head = parse_head("0 0 0 " + std::string(turn));
        ASSERT_TRUE(head) << turn;
        EXPECT_NEAR(head->orientation.w, std::sqrt(0.5), 1e-15) << turn;
        EXPECT_NEAR(head->orientation.y, std::sqrt(0.5), 1e-15) << turn;
    }
}

TEST(HeadPacket, InvalidPacketsAreRejectedWithTheReason) {
    for (const char* text : {"", "\n", "head", "1", "1 2", "1 2 3 4", "1 2 3 4 5 6", "head head 1 2 3 4 5 6"})
        EXPECT_NE(problem(text), "") << text;
    EXPECT_NE(problem("1 2 3 4 5 6 7 8").find("more than 7"), std::string::npos);
    for (const char* text : {"1 2 x", "1,2,3", "1 2 3x", "0x1 2 3", "1 2 +-3", "1 2 ++3", "1 2 +", "1 2 -",
                             "tail 1 2 3", "1 2 3\n4 5 6\n", "1 2 3\n\n", "1e999 2 3", "1 2 3\v"})
        EXPECT_NE(problem(text), "") << text;
    for (const char* text : {"nan 2 3", "1 inf 3", "1 2 -infinity", "1 2 3 nan 0 0 0", "1 2 3 1 0 0 inf"})
        EXPECT_NE(problem(text).find("not finite"), std::string::npos) << text;
    EXPECT_NE(problem("1 2 3 0 0 -0 0").find("is zero"), std::string::npos);
    EXPECT_NE(problem(std::string_view("1 2\0 3", 6)), "");
    EXPECT_NE(problem(std::string(508, ' ') + "1 2 3").find("longer than 512"), std::string::npos);
    EXPECT_EQ(problem(std::string(507, ' ') + "1 2 3"), "");
}

TEST(HeadPacket, ErrorsDoNotQuoteThePacket) {
    EXPECT_EQ(problem("\x1b[2J 2 3").find('\x1b'), std::string::npos);
}

bool is_sound(const display::Head& head) {
    const glm::dquat turn = head.orientation;
    const double length = std::hypot(std::hypot(turn.w, turn.x), std::hypot(turn.y, turn.z));
    return std::isfinite(head.position.x) && std::isfinite(head.position.y) &&
           std::isfinite(head.position.z) && std::abs(length - 1.0) < 1e-12;
}

// Any input gives a valid head or an error.
TEST(HeadPacket, AcceptsArbitraryBytes) {
    std::mt19937 random(11);
    const std::string likely = "0123456789+-.eE \t\n\rheadnaif";
    int read = 0;
    for (int i = 0; i < 200000; ++i) {
        std::string packet(random() % 40, '\0');
        const bool is_binary = i % 4 == 0;
        for (char& c : packet) c = is_binary ? char(random()) : likely[random() % likely.size()];
        const auto head = parse_head(packet);
        if (!head) continue;
        ASSERT_TRUE(is_sound(*head)) << packet;
    }
    for (int i = 0; i < 200000; ++i) {  // good ones with a byte changed, lost or more
        std::string packet = "head 0.125 -1.75 2e-3 0.5 -0.5 .5 +0.5\n";
        const std::size_t at = random() % packet.size();
        if (i % 3 == 0) packet[at] = char(random());
        if (i % 3 == 1) packet.erase(at, 1 + random() % 8);
        if (i % 3 == 2) packet.insert(at, 1 + random() % 3, likely[random() % likely.size()]);
        const auto head = parse_head(packet);
        if (!head) continue;
        ++read;
        ASSERT_TRUE(is_sound(*head)) << packet;
    }
    EXPECT_GT(read, 1000);
}

}  // namespace
}  // namespace tessera::tools
