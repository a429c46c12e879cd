// An output's pipeline allocates no memory per frame: counts operator new in the whole program.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "mediator/display/frustum.h"
#include "tests/display/pipeline_output.h"

namespace {

constexpr std::size_t Noted = 1024;  // larger allocations are counted (rows, planes), thread tasks are not
std::atomic<std::size_t> noted_bytes{0};

void* take(std::size_t bytes, std::size_t alignment) {
    if (bytes >= Noted) noted_bytes += bytes;
    void* memory = std::aligned_alloc(alignment, (bytes + alignment) / alignment * alignment);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

}  // namespace

void* operator new(std::size_t bytes) {
    return take(bytes, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
    return take(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}

namespace tessera::display {
namespace {

TEST(PipelineAllocation, NoAllocationAfterTheFirstRunEvenWhenTheHeadMoves) {
    scene::BlobStore arrays;
    Output output{.name = "screen", .width = 640, .height = 400, .stereo = Stereo::SideBySide};
    output.plane = test::wall();
    output.view_width = 640;
    output.view_height = 400;
    output.points =
        test::put(arrays, 2, 2, 3, Grid::Nodes::Edges, {-1, 0.5, -2, 1, 0.4f, -2, -1, -0.5, -2, 1, -0.5, -2});
    output.blend = {.left = 50};
    OutputPipeline pipeline(output, arrays);
    const test::Picture fine(640, 400, test::Rgb{0.5f, 0.5f, 0.5f}),
        coarse(80, 50, test::Rgb{0.5f, 0.5f, 0.5f});
    std::vector<std::uint8_t> device(pipeline.value_count());
    const std::vector<std::span<std::uint8_t>> devices{device};
    tbb::task_arena arena(2);
    Head head;
    const auto run = [&](const test::Picture& picture) {
        for (const view::Eye eye : {view::Eye::Left, view::Eye::Right})
            pipeline.set_frustum(eye, frustum(output.plane, head, eye, 0.06, 0.0));
        const std::array eyes{picture.half(), picture.half()};
        pipeline.run(arena, eyes, devices);
    };
    noted_bytes = 0;
    run(fine);
    EXPECT_GT(noted_bytes, 640u) << "the count sees rows";
    noted_bytes = 0;
    head.position.x = 0.1;
    run(coarse);
    run(fine);
    EXPECT_EQ(noted_bytes, 0u);
}

}  // namespace
}  // namespace tessera::display
