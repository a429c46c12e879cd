#include "backends/vulkan/device/barrier_plan.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace tessera::vulkan {

namespace {

using Kind = Access::Kind;
using Steps = std::vector<std::vector<Access>>;
using Barriers = std::vector<std::optional<Barrier>>;  // one before each step

Barriers plan(const Steps& steps) {
    BarrierPlan plan;
    Barriers barriers;
    for (const auto& step : steps) barriers.push_back(plan.before(step));
    return barriers;
}

bool is_write(const Access& access) {
    return access.kind == Kind::Write;
}

// By definition: whether some barrier between steps i and j orders the two accesses.
bool is_ordered(const Barriers& barriers, std::size_t i, const Access& first, std::size_t j,
                const Access& second) {
    for (std::size_t k = i + 1; k <= j; ++k) {
        if (!barriers[k]) continue;
        const bool order =
            (barriers[k]->sources & first.stage) != 0 && (barriers[k]->destinations & second.stage) != 0;
        if (order && (!is_write(first) || (barriers[k]->writers & first.stage) != 0)) return true;
    }
    return false;
}

bool is_rewritten_between(const Steps& steps, std::size_t i, std::size_t j, std::uint64_t resource) {
    for (std::size_t k = i + 1; k < j; ++k) {
        for (const Access& access : steps[k]) {
            if (access.resource == resource && is_write(access)) return true;
        }
    }
    return false;
}

bool is_sufficient(const Steps& steps, const Barriers& barriers) {
    for (std::size_t j = 0; j < steps.size(); ++j) {
        for (std::size_t i = 0; i < j; ++i) {
            for (const Access& first : steps[i]) {
                for (const Access& second : steps[j]) {
                    const bool is_hazard =
                        first.resource == second.resource && (is_write(first) || is_write(second));
                    if (!is_hazard || is_rewritten_between(steps, i, j, first.resource)) continue;
                    if (!is_ordered(barriers, i, first, j, second)) return false;
                }
            }
        }
    }
    return true;
}

std::size_t count(const Barriers& barriers) {
    return static_cast<std::size_t>(std::count_if(barriers.begin(), barriers.end(),
                                                  [](const auto& barrier) { return barrier.has_value(); }));
}

// The minimum number of sufficient full barriers, by brute force.
std::size_t fewest(const Steps& steps) {
    constexpr StageMask All = (1u << StageCount) - 1u;
    std::size_t best = steps.size();
    for (std::uint32_t places = 0; places < 1u << steps.size(); ++places) {
        Barriers barriers(steps.size());
        for (std::size_t k = 0; k < steps.size(); ++k) {
            if ((places >> k & 1u) != 0) barriers[k] = {All, All, All};
        }
        if (count(barriers) < best && is_sufficient(steps, barriers)) best = count(barriers);
    }
    return best;
}

Steps random_steps(std::mt19937& random, std::size_t length, std::span<const Stage> stages) {
    Steps steps(length);
    for (auto& step : steps) {
        const Stage stage = stages[random() % stages.size()];
        for (std::uint64_t resource = 0; resource < 4; ++resource) {
            if (random() % 3 != 0) continue;
            const bool writes = stage != Indirect && stage != Drawing && random() % 2 == 0;
            step.push_back({resource, stage, writes ? Kind::Write : Kind::Read});
        }
    }
    return steps;
}

TEST(BarrierPlan, OrdersAWriteBeforeItsReaders) {
    const Barriers barriers = plan({{{1, Transfer, Kind::Write}}, {{1, Compute, Kind::Read}}});
    EXPECT_FALSE(barriers[0]);
    ASSERT_TRUE(barriers[1]);
    EXPECT_EQ(barriers[1]->sources, StageMask(Transfer));
    EXPECT_EQ(barriers[1]->writers, StageMask(Transfer));
    EXPECT_EQ(barriers[1]->destinations, StageMask(Compute));
}

TEST(BarrierPlan, ReadersRunConcurrentlyWithoutFlushes) {
    const Barriers barriers = plan({{{1, Compute, Kind::Read}},
                                    {{1, Compute, Kind::Read}},
                                    {{1, Compute, Kind::Write}},
                                    {{2, Compute, Kind::Write}}});
    EXPECT_FALSE(barriers[1]);
    ASSERT_TRUE(barriers[2]) << "a write after reads";
    EXPECT_EQ(barriers[2]->writers, 0u);
    EXPECT_FALSE(barriers[3]) << "another resource";
}

TEST(BarrierPlan, OneBarrierCoversAllPreviousWrites) {
    const Barriers barriers = plan({{{1, Compute, Kind::Write}},
                                    {{2, Compute, Kind::Write}},
                                    {{1, Compute, Kind::Read}, {3, Compute, Kind::Write}},
                                    {{2, Compute, Kind::Read}}});
    EXPECT_TRUE(barriers[2]);
    EXPECT_FALSE(barriers[3]) << "covered by the previous barrier";
}

TEST(BarrierPlan, HostReadsNeedNoBarrier) {
    const Barriers barriers = plan({{{1, Compute, Kind::Write}},
                                    {{1, Host, Kind::Read}},
                                    {{1, Compute, Kind::Write}},
                                    {{1, Host, Kind::Read}}});
    EXPECT_TRUE(barriers[1]);
    ASSERT_TRUE(barriers[2]) << "a write after a write";
    EXPECT_EQ(barriers[2]->sources, StageMask(Compute));
    EXPECT_TRUE(barriers[3]);
}

TEST(BarrierPlan, ResetForgetsAllAccesses) {
    BarrierPlan plan;
    plan.before(std::vector<Access>{{1, Compute, Kind::Write}});
    EXPECT_EQ(plan.size(), 1u);
    plan.reset();
    EXPECT_EQ(plan.size(), 0u);
    EXPECT_FALSE(plan.before(std::vector<Access>{{1, Compute, Kind::Read}}));
}

TEST(BarrierPlan, RandomStepsGetSufficientAndMinimalBarriers) {
    std::mt19937 random(11);
    constexpr std::array Stages{Compute, Transfer, Indirect, Drawing, Attachment};
    for (int turn = 0; turn < 2000; ++turn) {
        const Steps steps = random_steps(random, 12, Stages);
        const Barriers barriers = plan(steps);
        ASSERT_TRUE(is_sufficient(steps, barriers)) << "turn " << turn;
        for (std::size_t k = 0; k < barriers.size(); ++k) {
            if (!barriers[k]) continue;
            Barriers less = barriers;
            less[k].reset();
            ASSERT_FALSE(is_sufficient(steps, less)) << "turn " << turn << ", barrier " << k;
        }
    }
}

TEST(BarrierPlan, DispatchesGetTheFewestBarriers) {
    std::mt19937 random(13);
    constexpr std::array Stages{Compute};
    for (int turn = 0; turn < 60; ++turn) {
        const Steps steps = random_steps(random, 9, Stages);
        ASSERT_EQ(count(plan(steps)), fewest(steps)) << "turn " << turn;
    }
}

}  // namespace

}  // namespace tessera::vulkan
