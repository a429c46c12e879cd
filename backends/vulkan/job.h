#pragma once

#include <cstddef>
#include <cstdint>

namespace tessera::vulkan {

// The push constants of shaders/trace.glsl: which samples of which pixels one dispatch traces. Item i of the
// dispatch is sample (first_item + i) / pixels after the first, of pixel (first_item + i) % pixels of those
// that are rendered. Value k of item i goes to values[k * item_count + i]; the last one is the count of rays, as bits.
struct Job {
    std::uint64_t scene = 0, view = 0, pool = 0, values = 0;  // addresses
    std::uint64_t first_sample = 0;
    std::uint32_t top = 0;  // of the acceleration structure, in items
    std::uint32_t x = 0, y = 0, width = 0;
    std::uint32_t pixels = 0;  // that are rendered
    std::uint32_t first_item = 0, item_count = 0;
    std::uint32_t tile_pixels = 0;
    // RASTERISED only: address of instance and triangle per pixel of the tile and sample, from the first one of the
    // dispatch on.
    std::uint64_t seen = 0;
    std::uint64_t indices = 0;  // address of those of the pixels in the tile; 0: all of the tile
};

static_assert(sizeof(Job) == 88 && offsetof(Job, seen) == 72 && offsetof(Job, indices) == 80);
static_assert(offsetof(Job, values) == 24 && offsetof(Job, first_sample) == 32);
static_assert(offsetof(Job, top) == 40 && offsetof(Job, x) == 44 && offsetof(Job, width) == 52);
static_assert(offsetof(Job, pixels) == 56 && offsetof(Job, first_item) == 60);
static_assert(offsetof(Job, item_count) == 64);

// The push constants of shaders/merge.comp: 2^level samples of each pixel become one block. Value k of sample
// s of pixel i is stored at values[((k << level) + s) * pixels + i]; plane p of it goes to planes[p * pixels +
// i]. The word after the planes is 0 unless the host has to merge instead.
struct MergeJob {
    std::uint64_t columns = 0, values = 0, planes = 0;  // addresses
    std::uint32_t pixels = 0, level = 0;
    std::uint32_t column_count = 0, plane_count = 0;
};
constexpr int MaxMergedLevel = 8;  // partial sums of a pixel are kept in registers

static_assert(sizeof(MergeJob) == 40);
static_assert(offsetof(MergeJob, planes) == 16 && offsetof(MergeJob, pixels) == 24);
static_assert(offsetof(MergeJob, column_count) == 32);

}  // namespace tessera::vulkan
