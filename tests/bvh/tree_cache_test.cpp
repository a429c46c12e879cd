// The disk cache of BVHs.
#include "backends/vulkan/bvh/tree_cache.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "backends/vulkan/bvh/tree_serialization.h"
#include "tests/bvh/traced_scene.h"

namespace tessera::vulkan {

namespace {

namespace fs = std::filesystem;

struct TreeCacheTest : testing::Test {
    TreeCacheTest() { fs::remove_all(folder); }
    ~TreeCacheTest() override { fs::remove_all(folder); }

    static MeshHashes hashes_of(const TestMesh& mesh) {
        return {blake2b(std::as_bytes(std::span(mesh.positions))),
                blake2b(std::as_bytes(std::span(mesh.triangles)))};
    }
    std::vector<fs::path> files() const {
        std::vector<fs::path> paths;
        for (const auto& entry : fs::directory_iterator(folder)) paths.push_back(entry.path());
        return paths;
    }
    const fs::path folder = fs::temp_directory_path() / ("tessera-trees-" + std::to_string(::getpid()));
    BinaryTreeBuilder builder;
    TestMesh mesh = ball(72, 5.0f, glm::vec3(0.0f));
    WideTree tree = build_mesh(builder, mesh.data());
};

TEST_F(TreeCacheTest, LoadsTheTreeOfTheSameMesh) {
    ASSERT_GE(mesh.triangles.size(), TreeCache::MinTriangles);
    EXPECT_FALSE(TreeCache(folder).load(mesh.data(), hashes_of(mesh)));
    TreeCache(folder).save(tree, hashes_of(mesh));
    TreeCache cache(folder);
    const auto back = cache.load(mesh.data(), hashes_of(mesh));
    ASSERT_TRUE(back);
    EXPECT_EQ(serialize_tree(*back), serialize_tree(tree));
    EXPECT_EQ(
        std::memcmp(back->nodes.data(), tree.nodes.data(), tree.nodes.size() * sizeof(shading::BvhNode)), 0);
    MeshHashes others = hashes_of(mesh);
    std::swap(others.positions, others.triangles);
    EXPECT_FALSE(cache.load(mesh.data(), others));
    EXPECT_FALSE(cache.load(mesh.data(), hashes_of(mesh), {.triangle = 0.5f}));
    EXPECT_FALSE(cache.load(mesh.data(), hashes_of(mesh), {.leaf_triangles = 1}));
    EXPECT_TRUE(cache.take_notes().empty());
}

TEST_F(TreeCacheTest, CachesNothingForSmallMeshesOrWithoutAFolder) {
    const TestMesh small = ball(24, 5.0f, glm::vec3(0.0f));
    TreeCache cache(folder), none("");
    cache.save(build_mesh(builder, small.data()), hashes_of(small));
    EXPECT_FALSE(cache.load(small.data(), hashes_of(small)));
    EXPECT_TRUE(files().empty());
    none.save(tree, hashes_of(mesh));
    EXPECT_FALSE(none.load(mesh.data(), hashes_of(mesh)));
}

TEST_F(TreeCacheTest, RespectsItsSizeLimit) {
    const std::uint64_t limit = 2 * serialize_tree(tree).size() + 1000;
    TreeCache cache(folder, limit);
    for (int i = 0; i < 5; ++i) {
        for (glm::vec3& p : mesh.positions) p.x += 1.0f;
        cache.save(build_mesh(builder, mesh.data()), hashes_of(mesh));
        std::uint64_t held = 0;
        for (const fs::path& path : files()) held += fs::file_size(path);
        EXPECT_LE(held, limit);
    }
    EXPECT_TRUE(cache.load(mesh.data(), hashes_of(mesh))) << "the last one is there";
}

TEST_F(TreeCacheTest, DamagedFilesAreReportedOnceAndRemoved) {
    CounterRandom random(62);
    TreeCache cache(folder);
    for (int round = 0; round < 60; ++round) {
        cache.save(tree, hashes_of(mesh));
        const fs::path path = files().at(0);
        const auto size = fs::file_size(path);
        const std::uint64_t place = round < 20 ? static_cast<std::uint64_t>(5 * round) : random.below(size);
        if (round % 3 == 0) {
            fs::resize_file(path, place);
        } else {
            std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
            file.seekg(static_cast<std::streamoff>(place));
            const int byte = file.get();
            file.seekp(static_cast<std::streamoff>(place));
            file.put(static_cast<char>(byte ^ 0x10));
        }
        EXPECT_FALSE(cache.load(mesh.data(), hashes_of(mesh))) << place;
        EXPECT_EQ(cache.take_notes().size(), 1u);
        EXPECT_TRUE(files().empty());
    }
}

// An intact file that has the tree of another mesh under this mesh's name.
TEST_F(TreeCacheTest, ATreeOfAnotherMeshIsReportedAndReplaced) {
    TestMesh other = mesh;
    for (glm::vec3& p : other.positions) p.x = -2.0f * p.y * p.x;
    TreeCache cache(folder);
    cache.save(build_mesh(builder, other.data()), hashes_of(mesh));
    EXPECT_FALSE(cache.load(mesh.data(), hashes_of(mesh)));
    const std::vector<std::string> notes = cache.take_notes();
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("is rebuilt"), std::string::npos);
    cache.save(tree, hashes_of(mesh));
    EXPECT_TRUE(cache.load(mesh.data(), hashes_of(mesh)));
}

}  // namespace

}  // namespace tessera::vulkan
