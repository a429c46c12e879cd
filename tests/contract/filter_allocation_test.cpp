// A second run of a filter on the same frame allocates nothing: operator new is counted for the whole program. TBB
// allocates tasks from its own pools, which do not use operator new and grow with the threads, not with frames.
#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "mediator/filter/choice.h"
#include "tests/contract/filter_cases.h"

namespace {

std::atomic<std::size_t> noted_bytes{0}, live_bytes{0};

void* take(std::size_t bytes, std::size_t alignment) {
    noted_bytes += bytes;
    void* memory = std::aligned_alloc(alignment, (bytes + alignment) / alignment * alignment);
    if (memory == nullptr) throw std::bad_alloc();
    live_bytes += malloc_usable_size(memory);
    return memory;
}

void give_back(void* memory) {
    live_bytes -= malloc_usable_size(memory);
    std::free(memory);
}

}  // namespace

void* operator new(std::size_t bytes) {
    return take(bytes, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
    return take(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
    give_back(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    give_back(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    give_back(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    give_back(memory);
}

namespace tessera::filter::test {
namespace {

class FilterAllocation : public FilterContract {};

TEST_P(FilterAllocation, NoneInALaterRunOfTheSameSize) {
    const Inputs inputs = room_inputs(300, 260, 2);
    Subject subject(entry(), inputs);
    for (int run = 0; run < 3; ++run) subject.picture(inputs);  // both halves of a history have been used
    noted_bytes = 0;
    subject.picture(inputs);
    EXPECT_EQ(noted_bytes, 0u) << name() << " allocates in its fourth run on one frame";
}

TEST(FilterAllocationCount, CountsASingleNumber) {
    noted_bytes = 0;
    const std::vector<float> one(1);
    EXPECT_EQ(noted_bytes, sizeof(float));
}

// The same for the inputs of filters.
TEST(InputsAllocation, NoneForTheNextFilmOfTheSameSize) {
    using enum frame::Channel;
    const auto sampler = [](std::uint32_t x, std::uint32_t y, std::uint64_t sample) {
        return room(300, 260, x, y, sample);
    };
    const frame::FilmTile film = synthetic_film(
        300, 260, 4, {Radiance, Albedo, Normal, Depth, ObjectIndex, FirstHalf, Alpha}, sampler);
    const view::View view = synthetic_view(300, 260);
    Inputs inputs;
    resolve_inputs(film, view, nullptr, inputs);
    noted_bytes = 0;
    resolve_inputs(film, view, nullptr, inputs);
    EXPECT_EQ(noted_bytes, 0u);
    EXPECT_TRUE(inputs.has(frame::Channel::Radiance));
}

// What a filter keeps and works with, beyond its inputs and the picture it returns. Lardinoije's nine floats are albedo,
// normal, and value, result and variance of the prefilter; albedo and normal are inputs here.
TEST(FilterMemory, FdfTakesLessThanNineFloatsPerPixel) {  // LT23
    constexpr std::uint32_t Size = 400;
    const Inputs inputs =
        synthetic_inputs(Size, Size, 2, [](auto x, auto y, auto i) { return room(Size, Size, x, y, i); },
                         {frame::Channel::Radiance, frame::Channel::Albedo, frame::Channel::Normal,
                          frame::Channel::Depth, frame::Channel::ShadingFeature});
    const Choice choice = parse_choice("fdf:blend=off", catalog()).value();  // the thesis' filter
    Output out;
    out.picture = Planes(Size, Size, inputs.color_components());
    tbb::task_arena arena(2);
    noted_bytes = 0;
    choice.entry->make(Size, Size)->run(inputs, choice.values, out, {arena, {}});
    const double bytes = double(noted_bytes) / double(inputs.pixel_count());
    RecordProperty("bytes_per_pixel", std::to_string(bytes));
    EXPECT_LE(bytes, 36.0);
    EXPECT_GE(bytes, 5 * 4.0);  // the planes that it is known to keep are counted
}

// Bytes per pixel that an instance keeps after its first film, or, with a history, its third.
double kept_bytes(const FilterEntry& entry, const Inputs& inputs, const Values& values) {
    Output out;
    tbb::task_arena arena(2);
    out.picture = Planes(inputs.width, inputs.height, inputs.color_components());
    const std::size_t before = live_bytes;
    const auto filter = entry.make(inputs.width, inputs.height);
    for (int film = 0; film < (entry.description.temporal ? 3 : 1); ++film)
        filter->run(inputs, values, out, {arena, {}});
    return double(live_bytes - before) / double(inputs.pixel_count());
}

TEST_P(FilterAllocation, AnInstanceKeepsNoMoreThanItsDescriptionSays) {
    const Description& description = entry().description;
    Inputs inputs = room_inputs(400, 300, 2);
    inputs.changes.film_restarted = true;
    std::fill_n(inputs.counts.row(0, 50) + 100, 100, 0.0f);  // holes need memory, too
    double most = kept_bytes(entry(), inputs, default_values(description));
    for (std::size_t p = 0; p < description.parameters.size(); ++p) {
        for (std::size_t choice = 0; choice < description.parameters[p].choices.size(); ++choice) {
            Values values = default_values(description);
            if (values[p] == double(choice)) continue;
            values[p] = double(choice);
            most = std::max(most, kept_bytes(entry(), inputs, values));
        }
    }
    RecordProperty("bytes_per_pixel", std::to_string(most));
    EXPECT_LE(most, description.bytes_per_pixel + 0.1);  // and some bytes
    EXPECT_GE(most, 0.75 * description.bytes_per_pixel) << "a view would be refused without need";
}

INSTANTIATE_TEST_SUITE_P(Catalog, FilterAllocation, testing::Range<std::size_t>(0, catalog().size()),
                         filter_name);

}  // namespace
}  // namespace tessera::filter::test
