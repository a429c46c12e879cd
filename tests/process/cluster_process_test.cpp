// Guarantees that need real processes: separate pids, CURVE sockets, kill -9.
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <set>

#include "tests/process/real_cluster.h"

namespace tessera::test {
namespace {

using nlohmann::json;

const std::vector<std::string> Small{"--size", "160x90", "--spp", "32", "--seed", "5"};

std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

void expect_exact_accounting(const json& result) {
    std::uint64_t samples = 0;
    for (const json& node : result["nodes"]) samples += node["samples"].get<std::uint64_t>();
    const std::uint64_t expected = result["width"].get<std::uint64_t>() *
                                   result["height"].get<std::uint64_t>() * result["spp"].get<std::uint64_t>();
    EXPECT_GE(samples, expected) << result.dump(1);
}

TEST(RealProcesses, MatchASingleProcessBitwise) {
    RealCluster cluster;
    const ChildProcess a = cluster.start_node("a"), b = cluster.start_node("b");
    const std::string scene = scene_file("room-1.glb");
    const json two = cluster.render("two", scene, Small + std::vector<std::string>{"--wait-nodes", "2:60"});
    const json one = render_embedded(cluster.folder(), "one", scene, Small);
    EXPECT_EQ(two["film_hash"], one["film_hash"]);
    expect_exact_accounting(two);

    std::set<int> pids;
    ASSERT_EQ(two["nodes"].size(), 2u);
    for (const json& node : two["nodes"]) {
        pids.insert(node["pid"].get<int>());
        EXPECT_GE(node["samples"].get<double>(), 0.1 * 160 * 90 * 32)
            << "a living node got less than a tenth";
    }
    EXPECT_EQ(pids, (std::set<int>{a.pid(), b.pid()}));
    // The statistics of every pixel were transferred at least once: counts may be omitted, planes may not.
    constexpr double BytesPerPixel = 4 * (6 + 6 + 6 + 3 + 3 + 1 + 2);
    EXPECT_GE(two["wire_bytes"]["film"].get<double>(), 160 * 90 * BytesPerPixel);

    const json other = cluster.render("other", scene, {"--size", "160x90", "--spp", "32", "--seed", "6"});
    EXPECT_NE(other["film_hash"], two["film_hash"]) << "another seed, the same bits";
    EXPECT_LT(other["wire_bytes"]["blobs"].get<double>(), 3 * two["wire_bytes"]["blobs"].get<double>());
}

// The null back-end with a fixed cost per sample makes the frame last long enough to kill processes.
const std::vector<std::string> SlowNode{"--backend", "null", "--simulate-cost", "20us"};
const std::vector<std::string> SlowFrame{"--size", "160x120", "--spp", "16", "--seed", "5"};

std::string expected_hash_of_slow_frame(const RealCluster& cluster) {
    const auto result = render_embedded(cluster.folder(), "expected", scene_file("still.glb"),
                                        SlowFrame + std::vector<std::string>{"--backend", "null"});
    return result["film_hash"];
}

std::uint64_t units_in_flight(const json& status, const std::string& name) {
    for (const json& node : status["nodes"]) {
        if (node["name"] == name) return node["units_in_flight"].get<std::uint64_t>();
    }
    return 0;
}

TEST(RealProcesses, KillingANodeChangesNothing) {
    RealCluster cluster;
    const ChildProcess a = cluster.start_node("a", SlowNode), b = cluster.start_node("b", SlowNode);
    ChildProcess render =
        cluster.start_render("frame", scene_file("still.glb"),
                             SlowFrame + std::vector<std::string>{"--wait-nodes", "2:60", "--json"});
    ASSERT_TRUE(cluster.wait_for([&](const json& status) { return units_in_flight(status, "b") > 0; }))
        << render.err();
    b.signal(SIGKILL);
    ASSERT_EQ(render.wait(std::chrono::minutes(3)).value_or(-1), 0) << render.err();
    const json result = json::parse(render.out());
    EXPECT_EQ(result["film_hash"].get<std::string>(), expected_hash_of_slow_frame(cluster));
    EXPECT_GT(result["units"]["reissued"].get<int>(), 0) << "the killed node held units";
    EXPECT_GT(result["units"]["lost"].get<int>(), 0);
}

// A spot light in fog over a floor: rays cross medium boundaries, and paths scatter in the medium.
std::string foggy_scene(const TemporaryFolder& folder) {
    const std::string path = folder / "fog.x3d";
    std::ofstream(path) << R"(<X3D version='3.3'><Scene>
<Viewpoint position='0 1 6'/>
<Shape><Appearance><CommonVolumeShader absorptionFactor='0.02 0.02 0.02' scatteringFactor='0.3 0.35 0.4'/></Appearance>
<Box size='5 4 5'/></Shape>
<Transform translation='0 -1.5 0'><Shape><Appearance><Material diffuseColor='0.6 0.5 0.4'/></Appearance>
<Box size='4 0.1 4'/></Shape></Transform>
<SpotLight location='0 1.8 0' direction='0.2 -1 0.1' intensity='20' cutOffAngle='0.6' beamWidth='0.3'/>
</Scene></X3D>)";
    return path;
}

TEST(RealProcesses, KillingANodeInAMediumChangesNothing) {
    const std::vector<std::string> frame{"--size", "160x120", "--spp", "128", "--seed", "5"};
    RealCluster cluster;
    const ChildProcess a = cluster.start_node("a"), b = cluster.start_node("b");
    const std::string scene = foggy_scene(cluster.folder());
    ChildProcess render = cluster.start_render(
        "frame", scene, frame + std::vector<std::string>{"--wait-nodes", "2:60", "--json"});
    ASSERT_TRUE(cluster.wait_for([&](const json& status) { return units_in_flight(status, "b") > 0; }))
        << render.err();
    b.signal(SIGKILL);
    ASSERT_EQ(render.wait(std::chrono::minutes(3)).value_or(-1), 0) << render.err();
    const json result = json::parse(render.out());
    EXPECT_GT(result["units"]["lost"].get<int>(), 0) << "the killed node held units";
    EXPECT_GT(result["units"]["reissued"].get<int>(), 0);
    const json one = render_embedded(cluster.folder(), "one", scene, frame);
    EXPECT_EQ(result["film_hash"], one["film_hash"]);
    const json other = render_embedded(cluster.folder(), "other", scene,
                                       {"--size", "160x120", "--spp", "128", "--seed", "6"});
    EXPECT_NE(other["film_hash"], one["film_hash"]) << "there is nothing to be seen";
}

TEST(RealProcesses, LateNodeTakesWork) {
    RealCluster cluster;
    const ChildProcess a = cluster.start_node("a", SlowNode);
    ChildProcess render = cluster.start_render("frame", scene_file("still.glb"),
                                               SlowFrame + std::vector<std::string>{"--json"});
    ASSERT_TRUE(cluster.wait_for([&](const json& status) { return units_in_flight(status, "a") > 0; }))
        << render.err();
    const ChildProcess b = cluster.start_node("b", SlowNode);
    ASSERT_EQ(render.wait(std::chrono::minutes(3)).value_or(-1), 0) << render.err();
    const json result = json::parse(render.out());
    EXPECT_EQ(result["film_hash"].get<std::string>(), expected_hash_of_slow_frame(cluster));
    std::set<int> pids;
    for (const json& node : result["nodes"]) pids.insert(node["pid"].get<int>());
    EXPECT_TRUE(pids.contains(b.pid())) << "the late node rendered nothing: " << result.dump(1);
}

TEST(RealProcesses, StoppedNodeReturnsItsUnits) {
    RealCluster cluster;
    ChildProcess a = cluster.start_node("a", SlowNode), b = cluster.start_node("b", SlowNode);
    ChildProcess render =
        cluster.start_render("frame", scene_file("still.glb"),
                             SlowFrame + std::vector<std::string>{"--wait-nodes", "2:60", "--json"});
    ASSERT_TRUE(cluster.wait_for([&](const json& status) { return units_in_flight(status, "b") > 0; }))
        << render.err();
    b.signal(SIGTERM);
    EXPECT_EQ(b.wait(std::chrono::seconds(30)).value_or(-1), 0) << b.err();
    ASSERT_EQ(render.wait(std::chrono::minutes(3)).value_or(-1), 0) << render.err();
    const json result = json::parse(render.out());
    EXPECT_EQ(result["film_hash"].get<std::string>(), expected_hash_of_slow_frame(cluster));
    EXPECT_EQ(result["units"]["lost"].get<int>(), 0) << "what it held was handed back, not lost";
}

TEST(RealProcesses, InterruptedRenderWritesTheMergedSamples) {
    RealCluster cluster;
    const ChildProcess a = cluster.start_node("a", SlowNode);
    ChildProcess render = cluster.start_render("frame", scene_file("still.glb"),
                                               {"--size", "160x120", "--spp", "4096", "--json"});
    ASSERT_TRUE(cluster.wait_for([&](const json& status) { return units_in_flight(status, "a") > 0; }))
        << render.err();
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    render.signal(SIGINT);
    EXPECT_EQ(render.wait(std::chrono::seconds(60)).value_or(-1), 130) << render.err();
    EXPECT_TRUE(std::filesystem::exists(cluster.folder() / "frame.exr"));
    EXPECT_TRUE(cluster.wait_for([&](const json& status) { return units_in_flight(status, "a") == 0; }))
        << "the node continues with work that no client needs";
}

TEST(RealProcesses, SecondRenderIsQueuedOrRejected) {
    RealCluster cluster;
    const ChildProcess a = cluster.start_node("a", SlowNode);
    ChildProcess first = cluster.start_render("first", scene_file("still.glb"), SlowFrame);
    ASSERT_TRUE(cluster.wait_for([&](const json& status) { return units_in_flight(status, "a") > 0; }))
        << first.err();
    ChildProcess hasty = cluster.start_render("hasty", scene_file("still.glb"), {"--spp", "1", "--no-wait"});
    EXPECT_EQ(hasty.wait(std::chrono::minutes(1)).value_or(-1), 75) << hasty.err();
    ChildProcess second =
        cluster.start_render("second", scene_file("still.glb"), {"--size", "32x32", "--spp", "1", "--json"});
    EXPECT_EQ(first.wait(std::chrono::minutes(3)).value_or(-1), 0) << first.err();
    EXPECT_EQ(second.wait(std::chrono::minutes(3)).value_or(-1), 0) << second.err();
}

// The journal has the scene and the checkpoint the film; client and nodes reconnect automatically.
TEST(RealProcesses, KillingTheMasterDuringABatchChangesNothing) {
    RealCluster cluster({"--heartbeat", "0.1", "--checkpoint", "0.3"}, RealCluster::Session::Kept);
    const ChildProcess a = cluster.start_node("a", SlowNode);
    ChildProcess render = cluster.start_render("frame", scene_file("still.glb"),
                                               SlowFrame + std::vector<std::string>{"--json"});
    for (int kill = 0; kill < 2; ++kill) {
        ASSERT_TRUE(cluster.wait_for([&](const json& status) { return units_in_flight(status, "a") > 0; }))
            << render.err();
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        cluster.kill_master();
        cluster.start_master();
    }
    ASSERT_EQ(render.wait(std::chrono::minutes(3)).value_or(-1), 0) << render.err();
    const json result = json::parse(render.out());
    EXPECT_EQ(result["film_hash"].get<std::string>(), expected_hash_of_slow_frame(cluster));
    EXPECT_EQ(result["spp"], 16);
    std::uint64_t samples = 0;  // since the last master was started
    for (const json& node : result["nodes"]) samples += node["samples"].get<std::uint64_t>();
    EXPECT_LT(samples, 160u * 120u * 16u) << "what was merged before its death was rendered once more";
    EXPECT_TRUE(cluster.wait_for([](const json& status) { return status["live"].is_null(); }))
        << "its scene goes with it";
}

TEST(RealProcesses, AJobOutlivesItsClientAndItsMaster) {
    RealCluster cluster({"--heartbeat", "0.1", "--checkpoint", "0.3"}, RealCluster::Session::Kept);
    const ChildProcess a = cluster.start_node("a", SlowNode);
    const auto tessera = [&](const std::string& label, std::vector<std::string> words) {
        words.insert(words.end(), {"--master", cluster.endpoint(), "--keys", cluster.keys()});
        ChildProcess process(cluster.folder().path(), label, "tessera", words);
        EXPECT_EQ(process.wait(std::chrono::minutes(3)).value_or(-1), 0) << process.err();
        return process.out();
    };
    const std::vector<std::string> submit{
        "render", scene_file("still.glb"),       "--name", "night", "--detach",
        "-o",     cluster.folder() / "night.exr"};
    tessera("submit", submit + SlowFrame);
    ASSERT_TRUE(cluster.wait_for([&](const json& status) { return units_in_flight(status, "a") > 0; }));
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    ChildProcess hasty(cluster.folder().path(), "hasty", "tessera",
                       {"fetch", "night", "--master", cluster.endpoint(), "--keys", cluster.keys()});
    EXPECT_EQ(hasty.wait(std::chrono::minutes(1)).value_or(-1), 75) << hasty.err();
    cluster.kill_master();
    cluster.start_master();
    int asked = 0;
    const auto job = [&] {
        return json::parse(tessera("jobs" + std::to_string(asked++), {"jobs", "--json"})).at(0);
    };
    while (!job()["ended"].get<bool>() && asked < 600)
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
    EXPECT_EQ(job()["outcome"], "complete");
    cluster.kill_master();  // what is kept is on the disk
    cluster.start_master();
    tessera("fetch", {"fetch", "night", "-o", cluster.folder() / "night.exr", "--remove"});
    const json expected = cluster.render("expected", scene_file("still.glb"), SlowFrame);
    EXPECT_EQ(expected["spp"], 16);
    ChildProcess compare(
        cluster.folder().path(), "compare", "tessera",
        {"compare", cluster.folder() / "night.exr", cluster.folder() / "expected.exr", "--json"});
    (void)compare.wait(std::chrono::minutes(1));
    EXPECT_LT(json::parse(compare.out())["relmse"].get<double>(), 1e-6) << compare.out() << compare.err();
    EXPECT_TRUE(json::parse(tessera("none", {"jobs", "--json"})).empty());
}

TEST(RealProcesses, UnknownKeyIsRejectedEverywhere) {
    RealCluster cluster;
    ChildProcess foreign_keys(cluster.folder().path(), "foreign", "tessera",
                              {"keys", cluster.folder() / "foreign"});
    ASSERT_EQ(foreign_keys.wait(std::chrono::seconds(30)).value_or(-1), 0);
    // The right master key, so that the handshake itself succeeds, and a pair that the allow-list does not
    // hold.
    std::filesystem::copy_file(cluster.folder() / "keys/master.public",
                               cluster.folder() / "foreign/master.public",
                               std::filesystem::copy_options::overwrite_existing);
    ChildProcess node(
        cluster.folder().path(), "stranger", "tessera-node",
        {"--master", cluster.endpoint(), "--keys", cluster.folder() / "foreign", "--backend", "null"});
    ChildProcess client(cluster.folder().path(), "strange-client", "tessera",
                        {"status", "--master", cluster.endpoint(), "--keys", cluster.folder() / "foreign"});
    EXPECT_EQ(client.wait(std::chrono::minutes(1)).value_or(-1), 69) << client.err();
    EXPECT_TRUE(cluster.status()["nodes"].empty());
}

TEST(RealProcesses, ReportMissingNodes) {
    RealCluster cluster;
    ChildProcess render = cluster.start_render("lonely", scene_file("still.glb"), {"--wait-nodes", "2:1"});
    EXPECT_EQ(render.wait(std::chrono::minutes(1)).value_or(-1), 69) << render.err();
    EXPECT_FALSE(std::filesystem::exists(cluster.folder() / "lonely.exr"));
}

}  // namespace
}  // namespace tessera::test
