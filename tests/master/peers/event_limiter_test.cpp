#include "master/peers/event_limiter.h"

#include <gtest/gtest.h>

#include <vector>

namespace tessera::master {
namespace {

using namespace std::chrono_literals;

struct ManualClock final : Clock {
    TimePoint time{1h};
    TimePoint now() const override { return time; }
};

TEST(EventLimiterTest, TextsOfPeersCannotForgeLinesOrMoveTheCursor) {
    EXPECT_EQ(escaped("node \x1b[2J a\nmaster: all is well\r\x7f"),
              "node \\x1b[2J a\\x0amaster: all is well\\x0d\\x7f");
    EXPECT_EQ(escaped("M\xc3\xbcller \xe2\x82\xac"), "M\xc3\xbcller \xe2\x82\xac") << "UTF-8 is kept";
    EXPECT_EQ(escaped("csi \xc2\x9b"
                      "31m"),
              "csi \\xc2\\x9b31m")
        << "as are none of its control characters";
    EXPECT_LT(escaped(std::string(100000, '\n')).size(), 2100u);
}

TEST(EventLimiterTest, AFloodLeavesOneLineASecondAndOthersPass) {
    ManualClock clock;
    std::vector<std::string> lines;
    EventLimiter limiter(clock, [&](const Event& event) { lines.push_back(event.text); });
    for (int i = 0; i < 1000; ++i)
        limiter({wire::Severity::Warning, "message of eve was dropped: number " + std::to_string(i)});
    limiter({wire::Severity::Info, "node a joined"});
    EXPECT_EQ(lines.size(), EventLimiter::PerSecond + 1u);
    clock.time += 2s;
    limiter.tick();
    ASSERT_EQ(lines.size(), EventLimiter::PerSecond + 2u);
    EXPECT_NE(lines.back().find("980 more messages"), std::string::npos) << lines.back();
    limiter.tick();
    EXPECT_EQ(lines.size(), EventLimiter::PerSecond + 2u) << "reported once";
    limiter({wire::Severity::Warning, "message of eve was dropped: again"});
    EXPECT_EQ(lines.size(), EventLimiter::PerSecond + 3u);
}

// A peer may choose another name each time.
TEST(EventLimiterTest, TextsThatAllBeginDifferentlyAreLimitedTogether) {
    ManualClock clock;
    std::vector<std::string> lines;
    EventLimiter limiter(clock, [&](const Event& event) { lines.push_back(event.text); });
    for (int i = 0; i < 5000; ++i)
        limiter({wire::Severity::Warning, std::to_string(i) + " was refused: it is no node"});
    EXPECT_EQ(lines.size(), std::size_t{EventLimiter::AllPerSecond});
    clock.time += 2s;
    limiter.tick();
    EXPECT_EQ(lines.back(), "4800 more messages were left out");
}

}  // namespace
}  // namespace tessera::master
