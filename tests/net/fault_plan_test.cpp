#include "mediator/net/fault_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "mediator/net/loopback.h"
#include "tests/net/net_support.h"

namespace tessera::net {

namespace {

using namespace std::chrono_literals;
constexpr std::uint64_t Count = 500;

struct Faulty {
    LoopbackHub hub{{.messages_per_queue = 4096}};
    std::unique_ptr<Channel> server = hub.server(), client;
    explicit Faulty(const FaultPlan& control, const FaultPlan& bulk = {})
        : client(with_faults(hub.client(Role::Node), control, bulk)) {}
};

// The numbers of Count messages that arrive once none is in transit.
std::vector<std::uint64_t> sent_through(const FaultPlan& plan, Link link = Link::Control) {
    Faulty faulty(plan, plan);
    std::vector<std::uint64_t> numbers;
    const auto drain = [&] {
        while (const auto message = next_message(*faulty.server, 0s))
            numbers.push_back(number_of(message->bytes));
    };
    for (std::uint64_t i = 0; i < Count; ++i) {
        EXPECT_EQ(faulty.client->send(link, ServerPeer, numbered(i)), SendResult::Sent);
        drain();
    }
    // A receive sends what has been delayed.
    faulty.client->receive(in(2 * plan.max_delay + 20ms));
    drain();
    return numbers;
}

// The same in the other direction.
std::vector<std::uint64_t> received_through(const FaultPlan& plan) {
    Faulty faulty(plan);
    faulty.client->send(Link::Bulk, ServerPeer, numbered(0));
    const PeerId bulk = next_message(*faulty.server)->peer;
    const PeerId control = bulk - 1;  // the loopback's numbering: control first
    for (std::uint64_t i = 0; i < Count; ++i) {
        EXPECT_EQ(faulty.server->send(Link::Control, control, numbered(i)), SendResult::Sent);
    }
    std::vector<std::uint64_t> numbers;
    // On a busy machine a thread may wait for its turn.
    while (const auto message =
               next_message(*faulty.client, numbers.empty() ? 5s : 2 * plan.max_delay + 100ms)) {
        numbers.push_back(number_of(message->bytes));
    }
    return numbers;
}

TEST(FaultPlan, IsDeterministicForASeed) {
    const FaultPlan plan{.seed = 11, .lose = 0.3, .duplicate = 0.2};
    const auto first = sent_through(plan);
    EXPECT_EQ(first, sent_through(plan));
    EXPECT_EQ(received_through(plan), received_through(plan));
    FaultPlan other = plan;
    other.seed = 12;
    EXPECT_NE(first, sent_through(other));
    EXPECT_NE(first, sent_through(plan, Link::Bulk)) << "links fail independently";
    EXPECT_NE(first, received_through(plan)) << "so do directions";
}

TEST(FaultPlan, LosesAndDuplicatesAtTheGivenRates) {
    for (const auto& numbers :
         {sent_through({.seed = 1, .lose = 0.5}), received_through({.seed = 1, .lose = 0.5})}) {
        EXPECT_NEAR(static_cast<double>(numbers.size()), Count * 0.5, 5 * std::sqrt(Count * 0.25));
        EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
    }
    const auto twice = sent_through({.seed = 1, .duplicate = 0.5});
    EXPECT_NEAR(static_cast<double>(twice.size()), Count * 1.5, 5 * std::sqrt(Count * 0.25));
    EXPECT_EQ(std::set<std::uint64_t>(twice.begin(), twice.end()).size(), Count);
    EXPECT_TRUE(sent_through({.seed = 1, .lose = 1}).empty());
}

TEST(FaultPlan, DelayKeepsOrderAndLosesNothing) {
    const FaultPlan plan{.seed = 3, .min_delay = 1ms, .max_delay = 10ms};
    for (const auto& numbers : {sent_through(plan), received_through(plan)}) {
        ASSERT_EQ(numbers.size(), Count);
        EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
    }
}

TEST(FaultPlan, DelayIsWaitedFor) {
    Faulty faulty({.min_delay = 30ms, .max_delay = 30ms});
    const TimePoint before = in(0s);
    faulty.client->send(Link::Control, ServerPeer, numbered(1));
    EXPECT_FALSE(next_message(*faulty.server, 0s).has_value());
    while (!next_message(*faulty.server, 0s)) faulty.client->receive(in(1ms));
    EXPECT_GE(in(0s) - before, 30ms);
}

TEST(FaultPlan, ReorderingLosesNothing) {
    for (const Duration delay : {Duration(0), Duration(5ms)}) {
        const FaultPlan plan{.seed = 4, .reorder = 0.3, .max_delay = delay};
        for (auto numbers : {sent_through(plan), received_through(plan)}) {
            ASSERT_EQ(numbers.size(), Count);
            EXPECT_FALSE(std::is_sorted(numbers.begin(), numbers.end()));
            std::sort(numbers.begin(), numbers.end());
            EXPECT_EQ(std::unique(numbers.begin(), numbers.end()), numbers.end());
        }
    }
}

TEST(FaultPlan, ACutAffectsBothDirectionsOfItsLinkOnly) {
    Faulty faulty({.cut_after_messages = 3});
    for (std::uint64_t i = 0; i < 2; ++i) faulty.client->send(Link::Control, ServerPeer, numbered(i));
    PeerId control = ServerPeer;
    for (int i = 0; i < 2; ++i) control = next_message(*faulty.server)->peer;
    faulty.server->send(Link::Control, control, numbered(2));
    EXPECT_TRUE(next_message(*faulty.client).has_value());

    faulty.server->send(Link::Control, control, numbered(3));
    EXPECT_FALSE(next_message(*faulty.client, 20ms).has_value());
    EXPECT_EQ(faulty.client->send(Link::Control, ServerPeer, numbered(4)), SendResult::Sent);
    EXPECT_FALSE(next_message(*faulty.server, 20ms).has_value());
    EXPECT_EQ(faulty.client->send(Link::Bulk, ServerPeer, numbered(5)), SendResult::Sent);
    EXPECT_TRUE(next_message(*faulty.server).has_value());
}

TEST(FaultPlan, AFullQueueOfOnePeerDoesNotHoldUpAnother) {
    LoopbackHub hub({.messages_per_queue = 4});
    const auto server = with_faults(hub.server(), {.seed = 1, .max_delay = 1ms}, {});
    const auto slow = hub.client(Role::Node), quick = hub.client(Role::Node);
    std::array<PeerId, 2> peers{};
    for (std::size_t i = 0; i < 2; ++i) {
        (i == 0 ? slow : quick)->send(Link::Control, ServerPeer, numbered(i));
        peers[i] = next_message(*server)->peer;
    }
    std::uint64_t sent = 0;
    while (sent < 100'000 && server->send(Link::Control, peers[0], numbered(sent)) == SendResult::Sent) {
        ++sent;
        server->receive(in(0s));
    }
    EXPECT_LT(sent, 100'000u) << "the queue is unbounded";
    EXPECT_EQ(server->send(Link::Control, peers[1], numbered(9)), SendResult::Sent);
    server->receive(in(10ms));
    EXPECT_TRUE(next_message(*quick, 0s).has_value());
    for (std::uint64_t i = 0; i < sent; ++i) {
        server->receive(in(0s));
        auto message = next_message(*slow, 0s);
        while (!message) {
            server->receive(in(1ms));
            message = next_message(*slow, 0s);
        }
        ASSERT_EQ(number_of(message->bytes), i);
    }
}

}  // namespace

}  // namespace tessera::net
