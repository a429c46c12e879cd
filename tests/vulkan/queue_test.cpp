#include <array>
#include <numeric>
#include <random>
#include <thread>

#include "tests/vulkan/add.comp.h"
#include "tests/vulkan/bound.comp.h"
#include "tests/vulkan/spin.comp.h"
#include "tests/vulkan/vulkan_test.h"

namespace tessera::vulkan {

namespace {

using Words = std::vector<std::uint32_t>;

struct Add {
    std::uint64_t a, b, to;
    std::uint32_t count, summand;
};

struct Spin {
    std::uint64_t numbers;
    std::uint32_t turns, unused;
};

class QueueTest : public VulkanTest {
  protected:
    static constexpr std::uint32_t Count = 4096;

    ComputePipeline adder() {
        return {device(), {.name = "add", .code = shaders::add_comp(), .push_bytes = sizeof(Add)}};
    }
    ComputePipeline spinner() {
        return {device(), {.name = "spin", .code = shaders::spin_comp(), .push_bytes = sizeof(Spin)}};
    }
    static Dispatch add(const ComputePipeline& kernel, const Buffer& a, const Buffer& b, const Buffer& to,
                        std::uint32_t summand) {
        return {.pipeline = &kernel,
                .arguments = Add{a.address(), b.address(), to.address(), Count, summand},
                .groups = {Count / 64},
                .reads = {&a, &b},
                .writes = {&to}};
    }
    static Dispatch spin(const ComputePipeline& kernel, const Buffer& numbers, std::uint32_t turns) {
        return {.pipeline = &kernel,
                .arguments = Spin{numbers.address(), turns, 0},
                .groups = {static_cast<std::uint32_t>(numbers.size() / 4 / 64)},
                .writes = {&numbers}};
    }
};

// Random chains over a few buffers, split randomly into submissions, against the host.
TEST_F(QueueTest, DependentStepsMatchTheHost) {
    const ComputePipeline kernel = adder();
    std::mt19937 random(5);
    constexpr std::size_t Buffers = 4;
    std::vector<Buffer> buffers;
    std::array<Words, Buffers> expected;
    for (std::size_t i = 0; i < Buffers; ++i) {
        expected[i].resize(Count);
        for (std::uint32_t& word : expected[i]) word = random();
        buffers.push_back(make_buffer(device(), expected[i]));
    }
    std::vector<Step> steps;
    for (int turn = 0; turn < 400; ++turn) {
        const std::size_t a = random() % Buffers, b = random() % Buffers, to = random() % Buffers;
        const std::uint32_t summand = random();
        switch (random() % 8) {
            case 0:
                steps.push_back(Fill{&buffers[to], 0, Count * 4, summand});
                std::fill(expected[to].begin(), expected[to].end(), summand);
                break;
            case 1:
                if (a == to) break;
                steps.push_back(Copy{&buffers[a], &buffers[to], 0, 0, Count * 4});
                expected[to] = expected[a];
                break;
            default: {
                steps.push_back(add(kernel, buffers[a], buffers[b], buffers[to], summand));
                Words sum(Count);
                for (std::uint32_t i = 0; i < Count; ++i) sum[i] = expected[a][i] + expected[b][i] + summand;
                expected[to] = std::move(sum);
            }
        }
        if (random() % 5 != 0) continue;
        device().queue().submit(steps);
        steps.clear();
    }
    device().queue().submit(steps);
    for (std::size_t i = 0; i < Buffers; ++i) {
        EXPECT_EQ(download<std::uint32_t>(device(), buffers[i]), expected[i]) << "buffer " << i;
    }
}

TEST_F(QueueTest, BindsTexelsAndStorage) {
    struct Bound {
        std::uint64_t to;
        std::uint32_t count, unused;
    };
    const ComputePipeline kernel(device(), {.name = "bound",
                                            .code = shaders::bound_comp(),
                                            .push_bytes = sizeof(Bound),
                                            .bindings = {{.index = 0, .kind = Binding::Kind::Texels},
                                                         {.index = 3, .kind = Binding::Kind::Storage}}});
    Words texels(4 * Count), storage(Count), expected(4 * Count);
    std::iota(texels.begin(), texels.end(), 7u);
    std::iota(storage.begin(), storage.end(), 100000u);
    for (std::size_t i = 0; i < expected.size(); ++i) expected[i] = texels[i] + storage[i / 4];
    const Buffer first = make_buffer(device(), texels), second = make_buffer(device(), storage);
    const Buffer to(device(), expected.size() * 4);
    const Dispatch dispatch{.pipeline = &kernel,
                            .arguments = Bound{to.address(), Count, 0},
                            .groups = {Count / 64},
                            .bound = {&first, &second},
                            .writes = {&to}};
    run(device(), dispatch);
    EXPECT_EQ(download<std::uint32_t>(device(), to), expected);
    const std::array<Step, 3> again{Fill{&to, 0, to.size(), 0}, dispatch,
                                    dispatch};  // needs more descriptor sets
    device().queue().submit(again).wait();
    EXPECT_EQ(download<std::uint32_t>(device(), to), expected);

    Dispatch lacking = dispatch;
    lacking.bound.pop_back();
    EXPECT_THROW(run(device(), lacking), Error);
}

TEST_F(QueueTest, AbandonedStepsFinishAndKeepTheirMemoryAlive) {
    const ComputePipeline kernel = spinner();
    const std::uint64_t before = device().memory().use()[0].used;
    for (int i = 0; i < 20; ++i) {
        const Buffer numbers(device(), 64 * 4);
        device().queue().submit(spin(kernel, numbers, 1000));
    }
    const Buffer numbers = make_buffer(device(), Words(64, 1));
    Submission last = device().queue().submit(spin(kernel, numbers, 100000));
    if (!is_instrumented()) {  // which waits after each submission
        EXPECT_FALSE(last.wait_for(std::chrono::nanoseconds(0)));
        EXPECT_FALSE(last.done());
    }
    last.wait();
    EXPECT_TRUE(last.done());
    device().queue().collect();
    EXPECT_LE(device().memory().use()[0].used - before, 4096u) << "dropped buffers still hold memory";
}

TEST_F(QueueTest, ReportsTimesOfSteps) {
    const ComputePipeline kernel = spinner();
    const Buffer numbers = make_buffer(device(), Words(64, 1));
    const std::array<Step, 3> steps{spin(kernel, numbers, 1), spin(kernel, numbers, 100000),
                                    spin(kernel, numbers, 1)};
    EXPECT_TRUE(device().queue().submit(steps).seconds().empty());
    ASSERT_GT(device().info().timestamp_period, 0.0f);
    EXPECT_EQ(device().queue().submit(steps, Timing::Total).seconds().size(), 1u);
    std::array<double, 3> least{1, 1, 1};  // minimum of several: other processes may delay any of them
    for (int turn = 0; turn < 8; ++turn) {
        const std::vector<double> each = device().queue().submit(steps, Timing::Steps).seconds();
        ASSERT_EQ(each.size(), 3u);
        for (std::size_t i = 0; i < 3; ++i) least[i] = std::min(least[i], each[i]);
    }
    EXPECT_GT(least[1], least[0]);
    EXPECT_GT(least[1], least[2]);
}

TEST_F(QueueTest, DownloadsOverlapWithTheNextDispatch) {
    const ComputePipeline kernel = adder();
    const Buffer ones = make_buffer(device(), Words(Count, 1));
    std::array<Buffer, 2> sums{Buffer(device(), Count * 4), Buffer(device(), Count * 4)};
    std::array<Download, 2> parts;
    for (std::uint32_t unit = 0; unit < 20; ++unit) {
        const std::size_t turn = unit % 2;
        if (unit >= 2) {
            Words seen(Count);
            const auto bytes = parts[turn].wait();
            std::memcpy(seen.data(), bytes.data(), bytes.size());
            EXPECT_EQ(seen, Words(Count, unit - 2 + 2)) << "unit " << unit - 2;
        }
        device().queue().submit(add(kernel, ones, ones, sums[turn], unit));
        parts[turn] = Download(device(), sums[turn], 0, Count * 4);
    }
}

TEST_F(QueueTest, AcceptsSubmissionsFromSeveralThreads) {
    const ComputePipeline kernel = adder();
    constexpr std::uint32_t Threads = 4, Turns = 40;
    std::array<Words, Threads> results;
    {
        std::vector<std::jthread> threads;
        for (std::uint32_t thread = 0; thread < Threads; ++thread) {
            threads.emplace_back([&, thread] {
                const Buffer sum = make_buffer(device(), Words(Count, thread)),
                             zero = make_buffer(device(), Words(Count, 0));
                for (std::uint32_t turn = 0; turn < Turns; ++turn) {
                    const Buffer one = make_buffer(device(), Words(Count, 1));
                    const Submission sent = device().queue().submit(add(kernel, sum, one, sum, 0));
                    device().queue().submit(add(kernel, sum, zero, sum, 1));
                    if (turn % 8 == 0) sent.wait();
                }
                results[thread] = download<std::uint32_t>(device(), sum);
            });
        }
    }
    for (std::uint32_t thread = 0; thread < Threads; ++thread) {
        EXPECT_EQ(results[thread], Words(Count, thread + 2 * Turns)) << "thread " << thread;
    }
}

TEST_F(QueueTest, RejectsInvalidStepsAndRunsNone) {
    const Buffer numbers = make_buffer(device(), Words(64, 1));
    const Buffer none;
    const std::array<Step, 2> beyond{Fill{&numbers, 0, 256, 9}, Fill{&numbers, 128, 132, 9}};
    EXPECT_THROW(device().queue().submit(beyond), Error);
    EXPECT_THROW(device().queue().submit(Copy{&none, &numbers, 0, 0, 4}), Error);
    EXPECT_THROW(device().queue().submit(Fill{&numbers, 2, 4, 9}), Error);
    EXPECT_EQ(download<std::uint32_t>(device(), numbers), Words(64, 1));
}

}  // namespace

}  // namespace tessera::vulkan
