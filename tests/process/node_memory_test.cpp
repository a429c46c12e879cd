// A node whose process may not allocate what a scene needs.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

#include "tests/process/real_cluster.h"

namespace tessera::test {
namespace {

using nlohmann::json;
using namespace std::chrono_literals;

template <class T>
void append(std::ofstream& file, T value) {
    file.write(reinterpret_cast<const char*>(&value), sizeof value);
}

// A curved surface of 2 * side * side triangles before a camera.
std::string large_scene(const TemporaryFolder& folder, std::uint32_t side) {
    const std::size_t corners = std::size_t{side + 1} * (side + 1), indices = std::size_t{6} * side * side;
    std::ofstream file(folder / "large.bin", std::ios::binary);
    for (std::uint32_t y = 0; y <= side; ++y) {
        for (std::uint32_t x = 0; x <= side; ++x) {
            const float u = 2.0f * float(x) / float(side) - 1.0f, v = 2.0f * float(y) / float(side) - 1.0f;
            for (const float value : {u, v, 0.2f * u * v - 3.0f}) append(file, value);
        }
    }
    for (std::uint32_t y = 0; y < side; ++y) {
        for (std::uint32_t x = 0; x < side; ++x) {
            const std::uint32_t a = y * (side + 1) + x, b = a + side + 1;
            for (const std::uint32_t corner : {a, a + 1, b + 1, a, b + 1, b}) append(file, corner);
        }
    }
    const json scene{
        {"asset", {{"version", "2.0"}}},
        {"scenes", {{{"nodes", {0, 1}}}}},
        {"nodes", {{{"mesh", 0}}, {{"camera", 0}}}},
        {"cameras", {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}}},
        {"materials", {{{"emissiveFactor", {1, 1, 1}}}}},
        {"meshes",
         {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}, {"material", 0}}}}}}},
        {"accessors",
         {{{"bufferView", 0},
           {"componentType", 5126},
           {"count", corners},
           {"type", "VEC3"},
           {"min", {-1, -1, -3.2}},
           {"max", {1, 1, -2.8}}},
          {{"bufferView", 1}, {"componentType", 5125}, {"count", indices}, {"type", "SCALAR"}}}},
        {"bufferViews",
         {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", 12 * corners}},
          {{"buffer", 0}, {"byteOffset", 12 * corners}, {"byteLength", 4 * indices}}}},
        {"buffers", {{{"uri", "large.bin"}, {"byteLength", 12 * corners + 4 * indices}}}}};
    std::ofstream(folder / "large.gltf") << scene.dump();
    return folder / "large.gltf";
}

// It gets so much address space beyond what it has.
void limit_memory(const ChildProcess& process, std::uint64_t more) {
    std::ifstream file("/proc/" + std::to_string(process.pid()) + "/statm");
    std::uint64_t pages = 0;
    file >> pages;
    const std::uint64_t bytes = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) + more;
    const rlimit limit{bytes, bytes};
    ASSERT_EQ(::prlimit(process.pid(), RLIMIT_AS, &limit, nullptr), 0);
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(NodeMemory, ThatIsTooSmallForAnyPartOfASceneIsSaidAndOthersRender) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer ends a process that cannot allocate";
#endif
    RealCluster cluster;
    // One cannot hold the scene's file, the other one not the tree over its triangles.
    ChildProcess tiny = cluster.start_node("tiny"), small = cluster.start_node("small");
    ASSERT_TRUE(cluster.wait_for([](const json& status) { return status["nodes"].size() == 2; }));
    limit_memory(tiny, 8u << 20);
    limit_memory(small, 64u << 20);
    const ChildProcess large = cluster.start_node("large");
    const std::vector<std::string> frame{"--size", "64x48", "--spp", "4", "--seed", "5"};
    const std::string scene = large_scene(cluster.folder(), 700);
    const json result = cluster.render("frame", scene, frame);
    ASSERT_EQ(result["nodes"].size(), 1u);
    EXPECT_EQ(result["nodes"][0]["pid"], large.pid());
    const json expected = render_embedded(cluster.folder(), "expected", scene, frame);
    EXPECT_EQ(result["film_hash"], expected["film_hash"]);

    EXPECT_EQ(tiny.wait(30s).value_or(-1), 69) << tiny.err();
    EXPECT_TRUE(has(tiny.err(), "tessera-node: out of memory")) << tiny.err();
    EXPECT_TRUE(has(small.err(), "memory") &&
                has(small.err(), "is kept; this node waits for another version"))
        << small.err();
    const std::string log = cluster.master().err();
    EXPECT_TRUE(has(log, "node tiny is gone: its connection broke")) << log;
    EXPECT_TRUE(has(log, "node small cannot build version")) << log;
    EXPECT_EQ(cluster.status()["nodes"].size(), 2u) << "the small one is there for the next scene";
}

}  // namespace
}  // namespace tessera::test
