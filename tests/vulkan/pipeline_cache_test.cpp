#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "tests/vulkan/square.comp.h"
#include "tests/vulkan/vulkan_test.h"

namespace tessera::vulkan {

namespace {

namespace fs = std::filesystem;

class PipelineCacheTest : public VulkanTest {
  protected:
    PipelineCacheTest() { fs::remove_all(folder_); }
    ~PipelineCacheTest() override { fs::remove_all(folder_); }

    // Squares 3 with a kernel made for `added`.
    std::uint32_t squared(std::uint32_t added) {
        struct Square {
            std::uint64_t numbers;
            std::uint32_t count, first;
        };
        const Buffer numbers = make_buffer(device(), std::vector<std::uint32_t>{3});
        const ComputePipeline kernel(device(), {.name = "square",
                                                .code = shaders::square_comp(),
                                                .constants = {{0, 64}, {1, added}},
                                                .push_bytes = sizeof(Square)});
        run(device(),
            {.pipeline = &kernel, .arguments = Square{numbers.address(), 1, 0}, .writes = {&numbers}});
        return download<std::uint32_t>(device(), numbers).front();
    }
    std::set<fs::path> files() const {
        std::set<fs::path> paths;
        for (const auto& entry : fs::directory_iterator(folder_)) paths.insert(entry.path());
        return paths;
    }
    const fs::path folder_ = fs::temp_directory_path() / ("tessera-pipelines-" + std::to_string(::getpid()));
};

TEST_F(PipelineCacheTest, KeepsAndReusesOneFilePerKernel) {
    reopen({.cache_folder = folder_});
    EXPECT_EQ(squared(1), 10u);
    EXPECT_EQ(squared(2), 11u);
    const std::set<fs::path> kept = files();
    EXPECT_EQ(kept.size(), 2u);
    for (const fs::path& path : kept) fs::last_write_time(path, fs::file_time_type{});
    reopen({.cache_folder = folder_});
    EXPECT_EQ(squared(1), 10u);
    EXPECT_EQ(squared(2), 11u);
    EXPECT_EQ(files(), kept);
    for (const fs::path& path : kept)
        EXPECT_NE(fs::last_write_time(path), fs::file_time_type{}) << "not used";
    EXPECT_TRUE(device().pipelines().take_notes().empty());
}

TEST_F(PipelineCacheTest, ADamagedFileIsReportedAndReplaced) {
    reopen({.cache_folder = folder_});
    squared(1);
    const fs::path path = *files().begin();
    const auto size = fs::file_size(path);
    fs::resize_file(path, size - 1);
    EXPECT_EQ(squared(1), 10u);
    EXPECT_EQ(device().pipelines().take_notes().size(), 1u);
    EXPECT_EQ(fs::file_size(path), size);
}

}  // namespace

}  // namespace tessera::vulkan
