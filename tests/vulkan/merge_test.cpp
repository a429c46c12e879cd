// Samples merged on a device and on the host: identical bits, or the device flags that the host has to merge.
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "backends/vulkan/job.h"
#include "backends/vulkan/kernels.h"
#include "backends/vulkan/merge_columns.h"
#include "backends/vulkan/unit_film.h"
#include "mediator/base/random.h"
#include "tests/vulkan/vulkan_test.h"

namespace tessera::vulkan {
namespace {

constexpr frame::ChannelSet AllChannels = frame::ChannelSet::all();

// Plausible values of the AOV channels.
using Draw = float (*)(CounterRandom&);

float any_sign(CounterRandom& random, float size) {
    return random.below(2) == 0 ? size : -size;
}
float typical(CounterRandom& random) {
    return any_sign(random, random.uniform());
}
// Any two of them differ by more than the square root of the smallest normal number, or are equal.
float huge_range(CounterRandom& random) {
    return any_sign(random, std::ldexp(1.0f + random.uniform(), static_cast<int>(random.below(60)) - 30));
}
float rarely_lit(CounterRandom& random) {
    return random.below(10) == 0 ? std::ldexp(1.0f, static_cast<int>(random.below(20))) : 0.0f;
}
float any_bits(CounterRandom& random) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(random.below(std::uint64_t{1} << 32)));
}
// Values around all limits: denormals, overflow, signed zero.
float extreme(CounterRandom& random) {
    using limits = std::numeric_limits<float>;
    constexpr std::array Values{0.0f,
                                -0.0f,
                                limits::denorm_min(),
                                1e-39f,
                                limits::min(),
                                1.5f * limits::min(),
                                1e-23f,
                                1.00001e-23f,
                                1e-19f,
                                1.0f,
                                1.0000001f,
                                1e19f,
                                limits::max(),
                                -1e-23f,
                                -limits::min(),
                                -limits::max(),
                                limits::infinity(),
                                limits::quiet_NaN()};
    return Values[random.below(Values.size())];
}

class Merging : public VulkanTest {
  protected:
    void SetUp() override {
        VulkanTest::SetUp();
        kernels_ = std::make_unique<Kernels>(device());
    }
    void TearDown() override {
        kernels_.reset();
        VulkanTest::TearDown();
    }

    static std::vector<float> samples(Draw draw, std::uint32_t pixels, std::uint32_t level,
                                      std::uint64_t seed) {
        CounterRandom random(seed);
        std::vector<float> values((std::size_t{value_count(AllChannels)} + 1) * pixels << level);
        for (float& value : values) value = draw(random);
        const std::size_t rays = std::size_t{value_count(AllChannels)} * pixels << level;
        for (std::size_t i = rays; i < values.size(); ++i) {
            values[i] = std::bit_cast<float>(static_cast<std::uint32_t>(1 + random.below(100)));
        }
        return values;
    }

    // The merged samples: by the device, if possible, and by the host.
    struct Both {
        std::optional<backend::RenderResult> device;
        backend::RenderResult host;
    };
    Both merge(const std::vector<float>& values, std::uint32_t pixels, std::uint32_t level) {
        const view::WorkUnit unit{.tile = {0, 0, static_cast<std::int32_t>(pixels), 1},
                                  .block = {std::uint64_t{1} << level, level}};
        const std::uint32_t planes = AllChannels.plane_count() + 1;
        const std::vector<MergeColumn> columns = merge_columns(AllChannels);
        const Buffer table = make_buffer(device(), columns), from = make_buffer(device(), values);
        const Buffer to = make_buffer(device(), std::vector<std::uint32_t>(planes * pixels + 1));
        const auto count = static_cast<std::uint32_t>(columns.size());
        run(device(), {.pipeline = &kernels_->merge_kernel().get(),
                       .arguments = MergeJob{.columns = table.address(),
                                             .values = from.address(),
                                             .planes = to.address(),
                                             .pixels = pixels,
                                             .level = level,
                                             .column_count = count,
                                             .plane_count = planes},
                       .groups = {(pixels * count + kernels_->group_size() - 1) / kernels_->group_size()},
                       .reads = {&from},
                       .writes = {&to}});
        const std::vector<float> merged = download<float>(device(), to);
        Both both;
        if (std::bit_cast<std::uint32_t>(merged.back()) == 0) {
            UnitFilm film(unit, AllChannels);
            film.add_block(std::span(merged).first(planes * pixels), unit.block);
            both.device = film.take(backend::RenderStatus::Done);
        }
        UnitFilm film(unit, AllChannels);
        film.add(values, pixels << level);
        both.host = film.take(backend::RenderStatus::Done);
        return both;
    }

    static void expect_same(const backend::RenderResult& a, const backend::RenderResult& b) {
        ASSERT_EQ(a.blocks.size(), 1u);
        ASSERT_EQ(b.blocks.size(), 1u);
        EXPECT_TRUE(frame::identical_bits(a.blocks[0], b.blocks[0]));
        EXPECT_EQ(a.rays, b.rays);
    }

  private:
    std::unique_ptr<Kernels> kernels_;
};

TEST_F(Merging, TheDeviceMatchesTheHostBitForBit) {
    for (const Draw draw : {typical, huge_range, rarely_lit}) {
        for (std::uint32_t level = 1; level <= MaxMergedLevel; ++level) {
            const Both both = merge(samples(draw, 37, level, level), 37, level);
            ASSERT_TRUE(both.device.has_value()) << "level " << level;
            expect_same(*both.device, both.host);
        }
    }
}

TEST_F(Merging, LeavesDenormalAndNonFiniteValuesToTheHost) {
    int done = 0, left = 0;
    for (std::uint64_t seed = 0; seed < 600; ++seed) {
        const auto level = static_cast<std::uint32_t>(1 + seed % 3);
        // Only one value is difficult: more would hide it.
        std::vector<float> values = samples(typical, 1, level, seed);
        CounterRandom random(seed + 1000);
        const std::uint64_t k = random.below(value_count(AllChannels));
        for (std::uint64_t s = 0; s < std::uint64_t{1} << level; ++s) {
            values[(k << level) + s] = seed % 2 == 0 ? extreme(random) : any_bits(random);
        }
        const Both both = merge(values, 1, level);
        ++(both.device ? done : left);
        if (both.device) expect_same(*both.device, both.host);
    }
    EXPECT_GT(done, 100);
    EXPECT_GT(left, 100);
}

// On any device: some flush denormals to 0.
TEST_F(Merging, FlagsResultsOutsideTheNormalRange) {
    using limits = std::numeric_limits<float>;
    struct Case {
        float first, second;
        bool is_left;
    };
    for (const Case& example :
         {Case{0.0f, -0.0f, false}, Case{1.0f, -1.0f, false}, Case{2.0f, 2.0f, false},
          Case{1e-39f, 1e-39f, true}, Case{1e-23f, 2e-23f, true},
          Case{limits::min(), -1.5f * limits::min(), true}, Case{1e20f, -1e20f, true},
          Case{limits::max(), limits::max(), true}, Case{limits::infinity(), 1.0f, true},
          Case{limits::quiet_NaN(), 1.0f, true}}) {
        std::vector<float> values = samples(typical, 1, 1, 7);
        values[0] = example.first;
        values[1] = example.second;
        EXPECT_EQ(!merge(values, 1, 1).device.has_value(), example.is_left)
            << example.first << " and " << example.second;
    }
}

}  // namespace
}  // namespace tessera::vulkan
