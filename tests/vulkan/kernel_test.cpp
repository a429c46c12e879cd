#include <algorithm>
#include <numeric>

#include "tests/vulkan/square.comp.h"
#include "tests/vulkan/vulkan_test.h"

namespace tessera::vulkan {

namespace {

struct Square {
    std::uint64_t numbers = 0;
    std::uint32_t count = 0, first = 0;
};

constexpr std::uint32_t GroupSize = 64;

class Kernel : public VulkanTest {
  protected:
    ComputePipeline square(std::uint32_t added = 0) {
        return {device(),
                {.name = "square",
                 .code = shaders::square_comp(),
                 .constants = {{0, GroupSize}, {1, added}},
                 .push_bytes = sizeof(Square)}};
    }
};

std::vector<std::uint32_t> counting(std::uint32_t count) {
    std::vector<std::uint32_t> numbers(count);
    std::iota(numbers.begin(), numbers.end(), 0u);
    return numbers;
}

TEST_F(Kernel, UsesItsSpecialisationConstants) {
    const Buffer numbers = make_buffer(device(), counting(1000));
    const ComputePipeline kernel = square(7);
    run(device(), {.pipeline = &kernel,
                   .arguments = Square{numbers.address(), 1000, 0},
                   .groups = {(1000 + GroupSize - 1) / GroupSize},
                   .writes = {&numbers}});
    std::vector<std::uint32_t> expected = counting(1000);
    for (std::uint32_t& number : expected) number = number * number + 7;
    EXPECT_EQ(download<std::uint32_t>(device(), numbers), expected);
}

// Storage descriptors of the software device end at 128 MiB; addresses do not.
TEST_F(Kernel, AddressesBeyondTheStorageBufferRange) {
    constexpr std::uint32_t Words = 280u << 18;  // 280 MiB
    constexpr std::uint32_t Tail = 4096;
    const Buffer numbers(device(), std::uint64_t(Words) * 4);
    const std::vector<std::uint32_t> in = counting(Tail);
    const std::uint64_t offset = std::uint64_t(Words - Tail) * 4;
    upload_bytes(device(), numbers, std::as_bytes(std::span(in)), offset);
    const ComputePipeline kernel = square();
    run(device(), {.pipeline = &kernel,
                   .arguments = Square{numbers.address(), Tail, Words - Tail},
                   .groups = {Tail / GroupSize},
                   .writes = {&numbers}});
    std::vector<std::uint32_t> out(Tail);
    download_bytes(device(), numbers, std::as_writable_bytes(std::span(out)), offset);
    for (std::uint32_t i = 0; i < Tail; ++i) ASSERT_EQ(out[i], i * i) << i;
}

TEST_F(Kernel, RejectsArgumentsOfTheWrongSize) {
    const ComputePipeline kernel = square();
    EXPECT_THROW(run(device(), {.pipeline = &kernel, .arguments = std::uint64_t(0)}), Error);
    EXPECT_THROW(run(device(), {.arguments = Square{}}), Error);
}

}  // namespace

}  // namespace tessera::vulkan
