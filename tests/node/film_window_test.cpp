// The window of film in flight, on a simulated link.
#include "node/film_window.h"

#include <gtest/gtest.h>

#include <deque>

namespace tessera::node {
namespace {

constexpr double MessageBytes = 442e3;

// A first-in, first-out link of a given rate and round-trip time, with an endless supply of film. Returns the longest time
// that a message spent in it after the first second, and the bytes per second that it carried.
struct LinkResult {
    double longest_delay = 0.0, rate = 0.0;
    std::uint64_t window = 0;
};
LinkResult simulate(double bytes_per_second, double round_trip, double seconds_in_all) {
    struct OnTheWay {
        double sent_at, taken_at;
        std::uint64_t end;
    };
    FilmWindow window;
    std::deque<OnTheWay> link;
    LinkResult result;
    double now = 0.0, free_at = 0.0;
    std::uint64_t sent = 0;
    const auto at = [](double time) { return TimePoint(Duration(static_cast<std::int64_t>(time * 1e9))); };
    while (now < seconds_in_all) {
        while (window.has_room()) {
            free_at = std::max(free_at, now) + MessageBytes / bytes_per_second;
            sent += static_cast<std::uint64_t>(MessageBytes);
            window.sent(static_cast<std::uint64_t>(MessageBytes), at(now));
            link.push_back({now, free_at + round_trip, sent});
        }
        const OnTheWay next = link.front();
        link.pop_front();
        now = next.taken_at;
        window.taken(next.end, at(now));
        if (next.sent_at > 1.0) result.longest_delay = std::max(result.longest_delay, now - next.sent_at);
    }
    result.rate = static_cast<double>(sent) / now;
    result.window = window.size();
    return result;
}

TEST(FilmWindow, ASaturatedLineHoldsLessThan100MillisecondsOfFilm) {
    for (const double line : {20e6, 125e6, 600e6}) {
        const LinkResult result = simulate(line, 1e-3, 5.0);
        EXPECT_LT(result.longest_delay, 0.1) << line;
        EXPECT_GT(result.rate, 0.9 * line) << "the line stays busy";
    }
}

TEST(FilmWindow, ALongLineIsFilled) {
    EXPECT_GT(simulate(125e6, 40e-3, 10.0).rate, 0.8 * 125e6);
}

// Slower than a message per target: one message at a time.
TEST(FilmWindow, ASlowLineStillGetsOneMessageAtATime) {
    const LinkResult result = simulate(1e6, 1e-3, 30.0);
    EXPECT_GT(result.rate, 0.9e6);
    EXPECT_EQ(result.window, FilmWindow::Smallest);
}

TEST(FilmWindow, IgnoresReportsThatCannotBe) {
    FilmWindow window;
    window.sent(1000, TimePoint{});
    window.taken(5000, TimePoint{});
    EXPECT_EQ(window.in_flight(), 1000u);
    window.taken(400, TimePoint{});
    window.taken(300, TimePoint{});
    EXPECT_EQ(window.in_flight(), 600u);
    window.restart();
    EXPECT_EQ(window.in_flight(), 0u);
    EXPECT_TRUE(window.has_room());
}

}  // namespace
}  // namespace tessera::node
