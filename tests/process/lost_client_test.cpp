// A frame outlives its client for a while: the client may come back, or another process fetches the picture.
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>

#include "tests/process/real_cluster.h"

namespace tessera::test {
namespace {

using nlohmann::json;
using namespace std::chrono_literals;

// 160x120 pixels of 16 samples take about 6 s.
const std::vector<std::string> LongFrame{"--size", "160x120", "--spp", "16", "--seed", "5"};

struct LostClients : testing::Test {
    std::optional<RealCluster> cluster;
    std::optional<ChildProcess> node;
    int asked = 0;

    void start(const std::string& orphan_seconds) {
        cluster.emplace(std::vector<std::string>{"--heartbeat", "0.25", "--orphan", orphan_seconds},
                        RealCluster::Session::None);
        node.emplace(cluster->start_node("a", {"--backend", "null", "--simulate-cost", "20us"}));
    }
    ChildProcess begin(const std::string& label, std::vector<std::string> more = {}) {
        more.insert(more.begin(), LongFrame.begin(), LongFrame.end());
        ChildProcess render = cluster->start_render(label, scene_file("still.glb"), more);
        EXPECT_TRUE(cluster->wait_for([](const json& status) {
            return !status["nodes"].empty() && status["nodes"][0]["units_in_flight"].get<int>() > 0;
        })) << render.err();
        return render;
    }
    std::string tessera(std::vector<std::string> words, int expected = 0) {
        words.insert(words.end(), {"--master", cluster->endpoint(), "--keys", cluster->keys()});
        ChildProcess process(cluster->folder().path(), "tool" + std::to_string(++asked), "tessera", words);
        EXPECT_EQ(process.wait(1min).value_or(-1), expected) << process.err();
        return process.out();
    }
    json jobs() { return json::parse(tessera({"jobs", "--json"})); }
    json wait_for_end() {
        for (int i = 0; i < 300; ++i) {
            const json listed = jobs();
            if (!listed.empty() && listed[0]["ended"].get<bool>()) return listed[0];
            std::this_thread::sleep_for(100ms);
        }
        ADD_FAILURE() << "the frame does not end";
        return {};
    }
    static void kill(ChildProcess& render) {
        render.signal(SIGKILL);
        (void)render.wait(1min);
    }
    std::string expected_hash() {
        std::vector<std::string> options = LongFrame;
        options.insert(options.end(), {"--backend", "null"});
        return render_embedded(cluster->folder(), "expected", scene_file("still.glb"), options)["film_hash"];
    }
};

TEST_F(LostClients, AStoppedClientContinuesWhereItWas) {
    start("600");
    ChildProcess render = begin("frame", {"--json"});
    render.signal(SIGSTOP);
    ASSERT_TRUE(cluster->wait_for([](const json& status) { return status["sessions"] == 1; }));
    const json lost = jobs();
    ASSERT_EQ(lost.size(), 1u) << "the master has given the client up, not its frame";
    EXPECT_FALSE(lost[0]["kept_until"].is_null());
    std::this_thread::sleep_for(8s);  // the frame ends meanwhile
    render.signal(SIGCONT);
    ASSERT_EQ(render.wait(1min).value_or(-1), 0) << render.err();
    const json result = json::parse(render.out());
    EXPECT_EQ(result["film_hash"].get<std::string>(), expected_hash());
    std::uint64_t samples = 0;
    for (const json& part : result["nodes"]) samples += part["samples"].get<std::uint64_t>();
    EXPECT_EQ(samples, 160u * 120u * 16u) << "nothing was rendered twice";
}

TEST_F(LostClients, AnotherProcessFetchesThePictureOfAKilledOne) {
    start("600");
    ChildProcess render = begin("frame");
    kill(render);
    ChildProcess next =
        cluster->start_render("next", scene_file("still.glb"), {"--size", "32x32", "--spp", "1"});
    const json job = wait_for_end();
    EXPECT_EQ(job["outcome"], "complete");
    EXPECT_EQ(next.wait(1min).value_or(-1), 0) << "the cluster is free again: " << next.err();
    EXPECT_EQ(job["name"].get<std::string>().rfind("lost-", 0), 0u) << "a name that one can type";
    const std::string name = job["name"], fetched = cluster->folder() / "fetched.exr";
    tessera({"fetch", name, "-o", fetched, "--remove"});
    cluster->render("again", scene_file("still.glb"), LongFrame);
    ChildProcess compare(cluster->folder().path(), "compare", "tessera",
                         {"compare", fetched, cluster->folder() / "again.exr", "--json"});
    (void)compare.wait(1min);
    EXPECT_LT(json::parse(compare.out())["relmse"].get<double>(), 1e-6) << compare.out() << compare.err();
    EXPECT_TRUE(jobs().empty());
}

TEST_F(LostClients, TheFrameEndsWithItsTime) {
    start("1");
    ChildProcess render = begin("frame");
    kill(render);
    EXPECT_TRUE(cluster->wait_for([](const json& status) {
        return status["live"].is_null() && status["units"]["cancelled"] > 0;
    })) << cluster->status().dump(1);
    EXPECT_TRUE(jobs().empty());
}

TEST_F(LostClients, ACancelledFrameMakesRoom) {
    start("600");
    ChildProcess render = begin("frame");
    kill(render);
    ASSERT_TRUE(cluster->wait_for([](const json& status) { return status["sessions"] == 1; }));
    ChildProcess next =
        cluster->start_render("next", scene_file("still.glb"), {"--size", "32x32", "--spp", "1"});
    ASSERT_TRUE(cluster->wait_for([](const json& status) { return status["queued"] == 1; })) << next.err();
    tessera({"jobs", "--cancel", jobs().at(0)["name"].get<std::string>()});
    EXPECT_EQ(next.wait(1min).value_or(-1), 0) << next.err();
}

}  // namespace
}  // namespace tessera::test
