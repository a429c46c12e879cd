#include "master/peers/quarantine.h"

#include <gtest/gtest.h>

namespace tessera::master {
namespace {

using namespace std::chrono_literals;

struct QuarantineTest : testing::Test {
    const Quarantine::Key Bad{"node", "render-7"}, Other{"node", "render-8"};
    Quarantine quarantine{{.fault_limit = 3, .forgiven_after = 10min, .first = 1min, .longest = 4min}};
    TimePoint now{1h};

    Duration rest() const { return *quarantine.find(Bad, now)->until - now; }
};

TEST_F(QuarantineTest, BeginsWithTheThirdFaultOfANode) {
    EXPECT_FALSE(quarantine.fault(Bad, "one", now));
    EXPECT_FALSE(quarantine.fault(Bad, "two", now));
    EXPECT_FALSE(quarantine.fault(Other, "another node", now));
    EXPECT_EQ(quarantine.find(Bad, now), nullptr);
    EXPECT_TRUE(quarantine.fault(Bad, "three", now));
    ASSERT_NE(quarantine.find(Bad, now), nullptr);
    EXPECT_EQ(quarantine.find(Bad, now)->reason, "three");
    EXPECT_EQ(quarantine.find(Other, now), nullptr);
}

TEST_F(QuarantineTest, LastsTwiceAsLongEachTime) {
    for (int i = 0; i < 3; ++i) quarantine.fault(Bad, "", now);
    for (const Duration expected : {Duration(1min), Duration(2min), Duration(4min), Duration(4min)}) {
        EXPECT_EQ(rest(), expected);
        now += rest();
        EXPECT_EQ(quarantine.find(Bad, now), nullptr);
        EXPECT_TRUE(quarantine.fault(Bad, "", now)) << "one more fault is enough after its return";
    }
}

TEST_F(QuarantineTest, ForgivesRareFaults) {
    for (int i = 0; i < 10; ++i) {
        EXPECT_FALSE(quarantine.fault(Bad, "once a while", now));
        now += 11min;
    }
}

TEST_F(QuarantineTest, NamesTheFaultsThatAreNotForgiven) {
    EXPECT_EQ(quarantine.faults(Bad, now), nullptr);
    quarantine.fault(Bad, "one", now);
    quarantine.fault(Bad, "two", now);
    ASSERT_NE(quarantine.faults(Bad, now), nullptr);
    EXPECT_EQ(quarantine.faults(Bad, now)->faults, 2u);
    EXPECT_EQ(quarantine.faults(Bad, now)->reason, "two");
    EXPECT_EQ(quarantine.faults(Other, now), nullptr);
    EXPECT_EQ(quarantine.faults(Bad, now + 11min), nullptr);
}

TEST_F(QuarantineTest, EndsByOrder) {
    EXPECT_FALSE(quarantine.release("render-7", now));
    for (int i = 0; i < 3; ++i) quarantine.fault(Bad, "", now);
    EXPECT_FALSE(quarantine.release("render-8", now));
    EXPECT_TRUE(quarantine.release("render-7", now));
    EXPECT_EQ(quarantine.find(Bad, now), nullptr);
    EXPECT_FALSE(quarantine.fault(Bad, "", now)) << "its record is clean";
}

TEST_F(QuarantineTest, RemembersABoundedNumberOfNodes) {
    for (int i = 0; i < 3; ++i) quarantine.fault(Bad, "", now);
    for (int i = 0; i < 5000; ++i) quarantine.fault({"node", std::to_string(i)}, "", now + Duration(1 + i));
    EXPECT_EQ(quarantine.find(Bad, now), nullptr) << "the oldest record makes room";
}

}  // namespace
}  // namespace tessera::master
