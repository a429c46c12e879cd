// Outputs as processes: they present frames together, and a stalled, crashed or restarted output does not affect
// the others.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>

#include "tests/process/display_cluster.h"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;

const std::vector<std::string> Names{"a", "b", "c", "d"};

display::Display wall_of_four() {
    display::Display wall{.name = "wall", .spp = 4, .coarsest = 1, .rate = 50.0};
    for (std::size_t i = 0; i < Names.size(); ++i)
        wall.outputs.push_back(part_of_wall(Names[i], -2.0 + double(i), -1.0 + double(i)));
    return wall;
}

struct OutputProcesses : testing::Test {
    DisplayCluster wall{2, RealCluster::Session::Kept};
    std::map<std::string, ChildProcess> outputs;

    void show(const std::string& name) {
        outputs.erase(name);
        outputs.emplace(name, wall.show(name));
    }
    void SetUp() override {
        for (const std::string& name : Names) show(name);
        wall.editor().open_display(wall_of_four());
        ASSERT_TRUE(wall.wait_until_locked(Names)) << wall.cluster().status().dump(1);
    }
    std::size_t lines(const std::string& name) const { return wall.log(name).size(); }
    bool shows_more(const std::string& name, std::size_t more) const {
        return happens([&, before = lines(name)] { return lines(name) >= before + more; });
    }
    // Over all frames shown: numbers only grow, and each frame has one version on all outputs.
    std::size_t check_logs() const {
        std::map<std::pair<std::uint64_t, std::uint64_t>, std::set<std::uint64_t>> versions;
        std::set<std::uint64_t> all;
        for (const std::string& name : Names) {
            std::uint64_t epoch = 0, frame = 0;
            for (const ShownFrame& shown : wall.log(name)) {
                if (shown.epoch == epoch) {
                    // A restarted process shows the current frame.
                    EXPECT_GE(shown.frame, frame) << "output " << name;
                }
                epoch = shown.epoch;
                frame = shown.frame;
                versions[{epoch, frame}].insert(shown.version);
                all.insert(shown.version);
            }
        }
        for (const auto& [key, numbers] : versions)
            EXPECT_EQ(numbers.size(), 1u) << "versions in frame " << key.second;
        return all.size();
    }
};

TEST_F(OutputProcesses, FramesArePresentedTogether) {
    {
        const MovingScene moving(wall);
        for (const std::string& name : Names) ASSERT_TRUE(shows_more(name, 60)) << outputs.at(name).err();
        // On a fast machine 60 frames are shown before a fifth edit.
        EXPECT_TRUE(happens([&] { return check_logs() > 4; })) << "nothing was edited";
    }
    std::map<std::uint64_t, std::vector<double>> times;
    std::uint64_t from = 0, to = ~std::uint64_t{0};
    for (const std::string& name : Names) {
        const auto frames = wall.log(name);
        for (std::size_t i = 1; i < frames.size(); ++i) EXPECT_GT(frames[i].frame, frames[i - 1].frame);
        for (const ShownFrame& shown : frames) times[shown.frame].push_back(shown.shown);
        from = std::max(from, frames.front().frame);
        to = std::min(to, frames.back().frame);
    }
    std::vector<double> spreads;
    std::size_t frames = 0;
    for (const auto& [frame, shown] : times) {
        if (frame < from || frame > to) continue;
        ++frames;
        if (shown.size() < Names.size()) continue;
        const auto [first, last] = std::minmax_element(shown.begin(), shown.end());
        spreads.push_back(*last - *first);
    }
    EXPECT_GE(spreads.size() * 10, frames * 8) << "outputs are left out of many frames";
    ASSERT_FALSE(spreads.empty());
    std::sort(spreads.begin(), spreads.end());
    const double median = spreads[spreads.size() / 2];
    std::cout << frames << " frames, " << spreads.size() << " of them on all outputs; between the first and "
              << "the last output: median " << 1e3 * median << " ms, p99 "
              << 1e3 * spreads[spreads.size() * 99 / 100] << " ms\n";
    EXPECT_LT(median, 1.0 / 60.0) << "outputs are further apart than a refresh";
}

TEST_F(OutputProcesses, StalledOutputDelaysNoOtherAndRecovers) {
    {
        const MovingScene moving(wall);
        ASSERT_TRUE(shows_more("c", 10));
        outputs.at("c").signal(SIGSTOP);
        EXPECT_TRUE(wall.wait_for_state("c", "late"));
        for (const std::string name : {"a", "b", "d"}) EXPECT_TRUE(shows_more(name, 5)) << name;
        EXPECT_TRUE(wall.wait_for_state("c", "absent")) << "it is silent for longer than three heartbeats";
        const auto last = wall.log("c").back();
        for (const std::string name : {"a", "b", "d"}) EXPECT_TRUE(shows_more(name, 5)) << name;
        outputs.at("c").signal(SIGCONT);
        EXPECT_TRUE(wall.wait_for_state("c", "locked"));
        EXPECT_TRUE(shows_more("c", 10));
        EXPECT_GT(wall.log("c").back().frame, last.frame + 10);
    }
    // They continued while it was late. The longest wait depends on the load of the machine.
    for (const std::string name : {"a", "b", "d"}) {
        const auto frames = wall.log(name);
        double longest = 0.0;
        for (std::size_t i = 1; i < frames.size(); ++i)
            longest = std::max(longest, frames[i].shown - frames[i - 1].shown);
        std::printf("output %s: %.2f s at most between two frames\n", name.c_str(), longest);
    }
    EXPECT_TRUE(wall.wait_until_the_same_is_shown(Names));
    EXPECT_GT(check_logs(), 4u);
}

TEST_F(OutputProcesses, KilledOutputIsAbsentUntilRestarted) {
    outputs.at("b").signal(SIGKILL);
    EXPECT_TRUE(wall.wait_for_state("b", "absent"));
    {
        const MovingScene moving(wall);
        for (const std::string name : {"a", "c", "d"}) EXPECT_TRUE(shows_more(name, 5)) << name;
        show("b");
        EXPECT_TRUE(wall.wait_for_state("b", "locked"));
        EXPECT_TRUE(shows_more("b", 5));
    }
    EXPECT_TRUE(wall.wait_until_the_same_is_shown(Names));
    check_logs();
}

TEST_F(OutputProcesses, OutputsWaitForACrashedMaster) {
    std::map<std::string, std::size_t> before;
    for (const std::string& name : Names) before[name] = lines(name);
    wall.cluster().kill_master();
    wall.cluster().start_master();
    wall.editor().open_display(wall_of_four());
    EXPECT_TRUE(wall.wait_until_locked(Names));
    for (const std::string& name : Names) {
        EXPECT_TRUE(happens([&] { return lines(name) > before[name]; })) << name;
        EXPECT_TRUE(outputs.at(name).running());
    }
    EXPECT_TRUE(wall.wait_until_the_same_is_shown(Names));
}

TEST_F(OutputProcesses, OutputsWaitForAClosedSceneAndDoNotOpenIt) {
    wall.editor().close_scene();
    for (const std::string& name : Names) {
        EXPECT_TRUE(happens([&] {
            return outputs.at(name).err().find("the live scene was closed; waiting") != std::string::npos;
        })) << outputs.at(name).err();
    }
    EXPECT_TRUE(wall.cluster().status().at("live").is_null());
    wall.begin_scene();
    wall.editor().open_display(wall_of_four());
    EXPECT_TRUE(wall.wait_until_locked(Names));
    EXPECT_TRUE(wall.wait_until_the_same_is_shown(Names));
}

TEST_F(OutputProcesses, ReopenedDisplayIsShownAgain) {
    wall.editor().close_display();
    EXPECT_TRUE(happens([&] { return outputs.at("a").err().find("closed") != std::string::npos; }))
        << "it says what it waits for: " << outputs.at("a").err();
    display::Display other = wall_of_four();
    other.outputs.pop_back();
    wall.editor().open_display(other);
    EXPECT_TRUE(wall.wait_until_locked({"a", "b", "c"}));
    wall.editor().open_display(wall_of_four());
    EXPECT_TRUE(wall.wait_until_locked(Names)) << "also those that the display did not have for a while";
    EXPECT_TRUE(wall.wait_until_the_same_is_shown(Names));
}

}  // namespace
}  // namespace tessera::test
