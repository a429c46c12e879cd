#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "mediator/base/random.h"
#include "tests/master/render/simulated_cluster.h"

// Random schedules of 32 nodes, each from a seed. One seed again:
//   TESSERA_SCHEDULE=17 GTEST_FILTER='*/mixed_stalls' build/release/tests/schedule_test
namespace tessera::master {
namespace {

enum class Events : std::uint8_t { None, SlowAndDead, Stalls };

struct Case {
    session::Policy policy;
    Events events;
};

struct Schedule {
    std::vector<SimulatedNodeSettings> nodes;
    PlanSettings plan;
};

class Draw {
  public:
    explicit Draw(std::uint64_t seed, std::uint64_t stream) : random_(seed, stream) {}
    double uniform(double from, double to) { return from + (to - from) * random_.uniform(); }
    double log_uniform(double from, double to) { return from * std::pow(to / from, random_.uniform()); }
    std::uint64_t below(std::uint64_t n) { return random_.below(n); }
    bool chance(double p) { return random_.uniform() < p; }

  private:
    CounterRandom random_;
};

constexpr std::size_t NodeCount = 32;

std::vector<SimulatedNodeSettings> draw_nodes(Draw& draw) {
    std::vector<SimulatedNodeSettings> nodes(NodeCount);
    for (SimulatedNodeSettings& node : nodes) {
        node.rate = draw.log_uniform(2e5, 16e5);
        node.workers = static_cast<std::uint32_t>(1 + draw.below(4));
        node.latency = draw.log_uniform(0.1e-3, 20e-3);
    }
    return nodes;
}

// A picture that takes the nodes `time` s, and its plan as ViewRunner makes it.
PlanSettings draw_plan(Draw& draw, const std::vector<SimulatedNodeSettings>& nodes, double time,
                       session::Policy policy) {
    double rate = 0.0;
    for (const SimulatedNodeSettings& node : nodes) rate += node.rate * node.workers;
    const double spp = draw.log_uniform(32.0, 2048.0);
    const double pixels = std::clamp(time * rate / spp, 640.0 * 480, 3840.0 * 2160);
    const double height = std::sqrt(pixels / draw.uniform(1.0, 2.4));
    PlanSettings plan{
        .window = {0, 0, static_cast<std::int32_t>(pixels / height), static_cast<std::int32_t>(height)},
        .tile = draw.chance(0.5) ? 64u : 32u,
        .spp = static_cast<std::uint64_t>(std::max(1.0, std::round(time * rate / pixels))),
        .policy = policy,
        .first_level = draw.chance(0.5) ? 2u : 0u};
    if (draw.chance(0.5)) plan.hold_film = std::chrono::seconds(2);
    return plan;
}

// Frames of 5 to 60 s, most of them short: there the start and the end weigh most.
Schedule draw_schedule(std::uint64_t seed, const Case& test) {
    Draw draw(seed, 10 * static_cast<std::uint64_t>(test.policy) + static_cast<std::uint64_t>(test.events));
    Schedule schedule{.nodes = draw_nodes(draw), .plan = {}};
    const double time = 5.0 * std::pow(12.0, std::pow(draw.uniform(0.0, 1.0), 4.0));
    schedule.plan = draw_plan(draw, schedule.nodes, time, test.policy);
    if (test.events == Events::None) return schedule;
    const std::uint64_t slow = draw.below(NodeCount),
                        dead = (slow + 1 + draw.below(NodeCount - 1)) % NodeCount;
    schedule.nodes[slow].slow_from = draw.uniform(0.0, time);
    schedule.nodes[slow].slow_factor = 0.1;
    schedule.nodes[dead].dies_at = draw.uniform(0.0, time);
    schedule.nodes[dead].dies_silently = draw.chance(0.5);
    if (test.events == Events::SlowAndDead) return schedule;
    SimulatedNodeSettings& stalls = schedule.nodes[draw.below(NodeCount)];
    stalls.stalls_at = draw.uniform(0.0, time);
    stalls.stalls_for = draw.log_uniform(0.1, 60.0);
    stalls.only_workers_stall = draw.chance(0.5);
    return schedule;
}

class Distribution {
  public:
    void add(double value, std::uint64_t seed) { values_.push_back({value, seed}); }
    void report(const char* name) {
        std::sort(values_.begin(), values_.end());
        const auto at = [&](double part) {
            return values_[static_cast<std::size_t>(part * static_cast<double>(values_.size() - 1))];
        };
        std::printf("%-16s median %.4f  99 %% %.4f  max %.4f (schedule %llu)\n", name, at(0.5).first,
                    at(0.99).first, at(1.0).first, static_cast<unsigned long long>(at(1.0).second));
        testing::Test::RecordProperty(std::string(name) + "_median", std::to_string(at(0.5).first));
        testing::Test::RecordProperty(std::string(name) + "_p99", std::to_string(at(0.99).first));
        testing::Test::RecordProperty(std::string(name) + "_max", std::to_string(at(1.0).first));
    }

  private:
    std::vector<std::pair<double, std::uint64_t>> values_;
};

class RandomSchedules : public testing::TestWithParam<Case> {
  protected:
    void run(std::uint64_t seed) {
        SCOPED_TRACE("schedule " + std::to_string(seed));
        const Schedule schedule = draw_schedule(seed, GetParam());
        SimulatedCluster cluster(schedule.nodes, schedule.plan);
        const double time = cluster.run(), ideal = cluster.ideal_time();
        EXPECT_TRUE(cluster.scheduler().complete());
        EXPECT_TRUE(cluster.scheduler().failed_tiles().empty());
        EXPECT_TRUE(cluster.is_covered(schedule.plan.spp));
        EXPECT_EQ(cluster.refused_films(), 0u);
        const session::UnitCounts counts = cluster.scheduler().counts();
        EXPECT_EQ(counts.issued + counts.reissued,
                  counts.merged + counts.duplicate + counts.cancelled + counts.refused + counts.lost);
        const auto work = static_cast<double>(schedule.plan.window.pixel_count() * schedule.plan.spp);
        const double ratio = time / ideal, duplicates = cluster.duplicated_samples() / work;
        EXPECT_LE(ratio, GetParam().events == Events::None ? 1.05 : 1.10) << "of " << ideal << " s";
        EXPECT_LE(duplicates, 0.02);
        if (std::getenv("TESSERA_SCHEDULE") != nullptr) describe(schedule, cluster, time, ideal);
        ratios_.add(ratio, seed);
        duplicates_.add(duplicates, seed);
        films_.add(
            static_cast<double>(cluster.films()) / static_cast<double>(cluster.scheduler().tiles().size()),
            seed);
    }
    void describe(const Schedule& schedule, const SimulatedCluster& cluster, double time, double ideal) {
        const PlanSettings& plan = schedule.plan;
        std::printf("%dx%d, tiles of %u, %llu spp, first level %u, film held %.1f s: %.3f s, ideal %.3f s\n",
                    plan.window.width, plan.window.height, plan.tile,
                    static_cast<unsigned long long>(plan.spp), plan.first_level, seconds(plan.hold_film),
                    time, ideal);
        for (std::size_t i = 0; i < schedule.nodes.size(); ++i) {
            const SimulatedNodeSettings& node = schedule.nodes[i];
            std::printf("%2zu: %.3g/s x %u, %.1f ms, %llu samples", i, node.rate, node.workers,
                        1e3 * node.latency, static_cast<unsigned long long>(cluster.samples_of(i)));
            if (node.dies_at < SimulatedNodeSettings::Never)
                std::printf(", dies %sat %.3f", node.dies_silently ? "silently " : "", node.dies_at);
            if (node.slow_from < SimulatedNodeSettings::Never)
                std::printf(", slow from %.3f", node.slow_from);
            if (node.stalls_at < SimulatedNodeSettings::Never)
                std::printf(", %s at %.3f for %.3f", node.only_workers_stall ? "workers stall" : "stalls",
                            node.stalls_at, node.stalls_for);
            std::printf("\n");
        }
    }
    void report() {
        ratios_.report("time");
        duplicates_.report("duplicates");
        films_.report("films_per_tile");
    }

  private:
    Distribution ratios_, duplicates_, films_;
};

constexpr std::uint64_t Cases = 9;

std::uint64_t number_from(const char* variable, std::uint64_t otherwise) {
    const char* text = std::getenv(variable);
    return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

TEST_P(RandomSchedules, StayNearTheIdeal) {
    const std::uint64_t one = number_from("TESSERA_SCHEDULE", 0);
    const std::uint64_t count = (number_from("TESSERA_SCHEDULES", 1000) + Cases - 1) / Cases;
    for (std::uint64_t seed = one > 0 ? one : 1; seed <= (one > 0 ? one : count); ++seed) run(seed);
    report();
}

std::string case_name(const testing::TestParamInfo<Case>& info) {
    const char* policies[] = {"tiled", "cooperative", "mixed"};
    const char* events[] = {"steady", "slow_and_dead", "stalls"};
    return std::string(policies[static_cast<int>(info.param.policy)]) + "_" +
           events[static_cast<int>(info.param.events)];
}

std::vector<Case> cases() {
    std::vector<Case> all;
    for (const auto policy : {session::Policy::Tiled, session::Policy::Cooperative, session::Policy::Mixed}) {
        for (const auto events : {Events::None, Events::SlowAndDead, Events::Stalls})
            all.push_back({policy, events});
    }
    return all;
}

INSTANTIATE_TEST_SUITE_P(Schedules, RandomSchedules, testing::ValuesIn(cases()), case_name);

}  // namespace
}  // namespace tessera::master
