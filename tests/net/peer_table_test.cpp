#include "mediator/net/peer_table.h"

#include <gtest/gtest.h>

namespace tessera::net {

namespace {

TEST(PeerTable, NumbersEachPeerOnce) {
    PeerTable table(8);
    PeerId next = 1;
    const PeerId a = table.number("a", "", next), b = table.number("b", "", next);
    EXPECT_NE(a, b);
    EXPECT_EQ(table.number("a", "", next), a);
    EXPECT_EQ(table.find(b)->routing_id, "b");
    table.forget(b);
    EXPECT_EQ(table.find(b), nullptr);
    EXPECT_GT(table.number("b", "", next), b) << "numbers are never reused";
}

TEST(PeerTable, EvictsTheLeastRecentlyUsed) {
    PeerTable table(3);
    PeerId next = 1;
    const PeerId a = table.number("a", "", next), b = table.number("b", "", next),
                 c = table.number("c", "", next);
    table.number("a", "", next);  // a speaks
    table.find(b);                // b is spoken to
    table.number("d", "", next);
    EXPECT_EQ(table.count(), 3u);
    EXPECT_EQ(table.find(c), nullptr);
    EXPECT_NE(table.find(a), nullptr);
    EXPECT_NE(table.find(b), nullptr);
}

TEST(PeerTable, StaysBounded) {
    PeerTable table(100);
    PeerId next = 1;
    for (int i = 0; i < 10'000; ++i) table.number(std::to_string(i), "user", next);
    EXPECT_EQ(table.count(), 100u);
    EXPECT_NE(table.find(next - 1), nullptr);
    EXPECT_EQ(table.find(next - 101), nullptr);
}

TEST(PeerTable, ARoutingIdOfAnotherUserIsAnotherPeer) {
    PeerTable table(8);
    PeerId next = 1;
    const PeerId victim = table.number("id", "node:victim:k1", next);
    const PeerId thief = table.number("id", "viewer:thief:k2", next);
    EXPECT_NE(thief, victim);
    EXPECT_EQ(table.find(victim), nullptr) << "messages for the old user must not reach the new one";
    EXPECT_EQ(table.find(thief)->user_id, "viewer:thief:k2");
    EXPECT_EQ(table.count(), 1u);
}

}  // namespace

}  // namespace tessera::net
