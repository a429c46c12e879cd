#pragma once

#include <cstddef>
#include <cstdint>

#include "mediator/shading/raster.h"

// The push constants of shaders/raster*, and the records they read; addresses come first.
namespace tessera::vulkan {

// Which instances a draw list includes.
enum class CullStage : std::uint32_t {
    LastVisible,  // in the frustum of the area, and visible the last time
    Unoccluded,   // in the frustum, and not occluded by the depth pyramid; recorded for the next time
    InFrustum,
    None  // no culling
};

// Edge of the squares of pixels that are one pixel in the next level of the depth pyramid.
inline constexpr std::uint32_t PyramidStep = 4;

struct DrawJob {
    std::uint64_t scene = 0, view = 0;
    std::uint64_t index = 0;  // of the sample
    shading::RasterCell cell{};
};

struct CullJob {
    std::uint64_t view = 0, bounds = 0, draws = 0;
    std::uint64_t seen = 0;    // per instance: 1 if it was visible the last time, else 0
    std::uint64_t depths = 0;  // of the area, followed by the levels of the depth pyramid
    shading::RasterCell cell{};
    std::uint32_t x = 0, y = 0, width = 0, height = 0;  // the area, in the cell
    std::uint32_t count = 0;                            // of instances
    std::uint32_t per_call = 1;
    CullStage stage = CullStage::None;
    std::uint32_t unused = 0;
};

// Offsets are in floats.
struct PyramidJob {
    std::uint64_t depths = 0;
    std::uint32_t from = 0, to = 0;
    std::uint32_t width = 0, height = 0;  // of the level below
};

// The bounds of an instance, relative to the render origin like all positions.
struct RasterBound {
    glm::vec3 low{0.0f};
    std::uint32_t vertices = 0;  // to draw; 0: excluded, from ray tracing too
    glm::vec3 high{0.0f};
    std::uint32_t layers = shading::AllLayers;  // visible to views that include one of them
};

static_assert(sizeof(shading::RasterCell) == 32 && offsetof(shading::RasterCell, shift) == 8);
static_assert(offsetof(shading::RasterCell, x) == 16 && offsetof(shading::RasterCell, edge) == 24);
static_assert(sizeof(DrawJob) == 56 && offsetof(DrawJob, index) == 16 && offsetof(DrawJob, cell) == 24);
static_assert(sizeof(CullJob) == 104 && offsetof(CullJob, seen) == 24 && offsetof(CullJob, cell) == 40);
static_assert(offsetof(CullJob, x) == 72 && offsetof(CullJob, count) == 88 && offsetof(CullJob, stage) == 96);
static_assert(sizeof(PyramidJob) == 24 && offsetof(PyramidJob, width) == 16);
static_assert(sizeof(RasterBound) == 32 && offsetof(RasterBound, vertices) == 12);
static_assert(offsetof(RasterBound, high) == 16 && offsetof(RasterBound, layers) == 28);

}  // namespace tessera::vulkan
