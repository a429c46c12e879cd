#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <string>

#include "tests/vulkan/spin.comp.h"
#include "tests/vulkan/square.comp.h"
#include "tests/vulkan/vulkan_test.h"

namespace tessera::vulkan {

namespace {

using Words = std::vector<std::uint32_t>;
constexpr std::uint64_t MiB = 1 << 20;

class MemoryTest : public VulkanTest {
  protected:
    std::uint64_t used() {
        std::uint64_t sum = 0;
        for (const HeapUse& heap : device().memory().use()) sum += heap.used;
        return sum;
    }
    std::uint64_t reserved() {
        std::uint64_t sum = 0;
        for (const HeapUse& heap : device().memory().use()) sum += heap.reserved;
        return sum;
    }
};

TEST_F(MemoryTest, RandomBuffersKeepTheirContentsAndAreFreed) {
    struct LiveBuffer {
        Buffer buffer;
        std::uint32_t mark;
    };
    std::mt19937 random(9);
    std::vector<LiveBuffer> buffers;
    constexpr std::array Kinds{MemoryKind::Device, MemoryKind::Upload, MemoryKind::Readback};
    for (std::uint32_t turn = 0; turn < 600; ++turn) {
        if (buffers.empty() || random() % 5 < 3) {
            const std::uint64_t words = random() % (random() % 16 == 0 ? 4 * MiB : 20000);
            LiveBuffer one{Buffer(device(), words * 4, Kinds[random() % Kinds.size()]), turn};
            EXPECT_EQ(one.buffer.address() % 16, 0u);
            device().queue().submit(Fill{&one.buffer, 0, words * 4, turn});
            buffers.push_back(std::move(one));
        } else {
            std::swap(buffers[random() % buffers.size()], buffers.back());
            const LiveBuffer& last = buffers.back();
            EXPECT_EQ(download<std::uint32_t>(device(), last.buffer),
                      Words(last.buffer.size() / 4, last.mark));
            buffers.pop_back();
        }
    }
    for (const LiveBuffer& one : buffers) {
        ASSERT_EQ(download<std::uint32_t>(device(), one.buffer), Words(one.buffer.size() / 4, one.mark));
    }
    EXPECT_GT(used(), 0u);
    buffers.clear();
    device().queue().latest().wait();
    device().queue().collect();
    EXPECT_EQ(used(), 0u);
}

TEST_F(MemoryTest, OutOfMemoryErrorsStateTheSizes) {
    reopen({.memory = {.limit = 64 * MiB}});
    const Buffer first(device(), 40 * MiB);
    try {
        const Buffer second(device(), 30 * MiB);
        FAIL() << "70 MiB fit into 64";
    } catch (const Error& error) {
        EXPECT_EQ(int(error.code()), int(ErrorCode::OutOfMemory));
        const std::string text = error.what();
        for (const std::uint64_t bytes : {30 * MiB, 40 * MiB, 24 * MiB}) {
            EXPECT_NE(text.find(std::to_string(bytes) + " "), std::string::npos) << bytes << " in: " << text;
        }
    }
    const Buffer rest(device(), 20 * MiB);
    EXPECT_THROW(Buffer(device(), 1ull << 62), Error);
}

// A scene that replaces another one of its size must not need memory for both once the first is dropped.
TEST_F(MemoryTest, AllocationWaitsForMemoryOfDroppedBuffers) {
    reopen({.memory = {.limit = 64 * MiB}});
    for (int turn = 0; turn < 10; ++turn) {
        std::vector<Buffer> scene;
        for (int i = 0; i < 5; ++i) scene.emplace_back(device(), 10 * MiB);
        const Buffer large(device(), 12 * MiB);
        device().queue().submit(Fill{&large, 0, large.size(), 1});  // still running when it is dropped
    }
    const Buffer all(device(), 60 * MiB);
}

TEST_F(MemoryTest, ReallocatingEqualBuffersReservesNoMoreMemory) {
    std::vector<Buffer> buffers;
    for (int i = 0; i < 50; ++i) buffers.emplace_back(device(), 2 * MiB);
    const std::uint64_t before = reserved();
    std::mt19937 random(2);
    for (int turn = 0; turn < 300; ++turn) {
        Buffer& buffer = buffers[random() % buffers.size()];
        buffer = Buffer();
        buffer = Buffer(device(), 2 * MiB);
    }
    EXPECT_EQ(reserved(), before);
    buffers.clear();
    EXPECT_LT(reserved(), before) << "empty blocks are not returned to the driver";
}

TEST_F(MemoryTest, UploadsToUnmappedMemoryAreStaged) {
    reopen({.memory = {.mapping = MemorySettings::Mapping::Separate}});
    Words words(7 * MiB);  // several turns of the staging memory
    std::iota(words.begin(), words.end(), 3u);
    // A busy queue: staging memory must not be overwritten before it was copied.
    struct Spin {
        std::uint64_t numbers;
        std::uint32_t turns, unused;
    };
    const Buffer turned(device(), 64 * 4);
    const ComputePipeline spin(device(), {.name = "spin", .code = shaders::spin_comp(), .push_bytes = 16});
    device().queue().submit(
        Dispatch{.pipeline = &spin, .arguments = Spin{turned.address(), 300000, 0}, .writes = {&turned}});
    const Buffer buffer = make_buffer(device(), words);
    EXPECT_TRUE(buffer.mapped().empty());
    EXPECT_EQ(device().uploaded_bytes(), words.size() * 4);
    EXPECT_EQ(download<std::uint32_t>(device(), buffer), words);

    // A kernel after the upload sees the data without naming the buffer.
    struct Square {
        std::uint64_t numbers;
        std::uint32_t count, first;
    };
    const ComputePipeline kernel(
        device(),
        {.name = "square", .code = shaders::square_comp(), .constants = {{0, 64}}, .push_bytes = 16});
    run(device(), {.pipeline = &kernel,
                   .arguments = Square{buffer.address(), 64, 0},
                   .groups = {1},
                   .writes = {&buffer}});
    for (std::uint32_t i = 0; i < 64; ++i) words[i] *= words[i];
    EXPECT_EQ(download<std::uint32_t>(device(), buffer), words);

    const std::array<std::byte, 3> odd{std::byte{1}, std::byte{2}, std::byte{3}};
    std::array<std::byte, 3> seen{};
    upload_bytes(device(), buffer, odd, 5);
    download_bytes(device(), buffer, seen, 5);
    EXPECT_EQ(seen, odd);
    EXPECT_THROW(upload_bytes(device(), buffer, odd, buffer.size() - 2), Error);
}

TEST_F(MemoryTest, AnEmptyBufferHasAnAddress) {
    const Buffer buffer = make_buffer(device(), Words());
    EXPECT_EQ(buffer.size(), 0u);
    EXPECT_NE(buffer.address(), 0u);
    EXPECT_TRUE(download<std::uint32_t>(device(), buffer).empty());
}

}  // namespace

}  // namespace tessera::vulkan
