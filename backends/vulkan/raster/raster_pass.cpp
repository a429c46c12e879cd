#include "backends/vulkan/raster/raster_pass.h"

#include <algorithm>

#include "backends/vulkan/raster/raster_cell.h"
#include "backends/vulkan/raster/raster_jobs.h"

namespace tessera::vulkan {

namespace {

std::uint32_t groups_for(std::uint32_t items, std::uint32_t group_size) {
    return (items + group_size - 1) / group_size;
}

std::uint32_t level_below(std::uint32_t edge) {
    return (edge + PyramidStep - 1) / PyramidStep;
}

// The steps of one part of a cell.
class PartSteps {
  public:
    PartSteps(const RasterPass& pass, std::vector<Step>& steps, const CellPart& part, std::uint64_t index)
        : pass_(pass),
          steps_(steps),
          part_(part),
          index_(index),
          cell_(make_cell(pass.view, part, index)),
          per_call_(std::min(pass.settings.draws_per_call, pass.device.info().draws_per_call)) {}

    void add() {
        const std::uint32_t count = pass_.target.instances;
        if (pass_.settings.culling == RasterSettings::Culling::Off) {
            cull(CullStage::None);
            draw(DrawList::Depth::Clear);
        } else if (count < pass_.settings.occlusion_min_instances) {
            cull(CullStage::InFrustum);
            draw(DrawList::Depth::Clear);
        } else {
            cull(CullStage::LastVisible);
            draw(DrawList::Depth::Clear);
            build_depth_pyramid();
            cull(CullStage::Unoccluded);
            draw(DrawList::Depth::Keep);
        }
    }

  private:
    std::uint32_t width() const { return static_cast<std::uint32_t>(part_.area.width); }
    std::uint32_t height() const { return static_cast<std::uint32_t>(part_.area.height); }

    void cull(CullStage stage) {
        RasterTarget& target = pass_.target;
        Dispatch dispatch{.pipeline = &pass_.kernels.cull,
                          .arguments = CullJob{.view = pass_.view_address,
                                               .bounds = pass_.scene.bounds().address(),
                                               .draws = target.draws.address(),
                                               .seen = target.seen.address(),
                                               .depths = target.depths.address(),
                                               .cell = cell_,
                                               .x = static_cast<std::uint32_t>(part_.area.x),
                                               .y = static_cast<std::uint32_t>(part_.area.y),
                                               .width = width(),
                                               .height = height(),
                                               .count = target.instances,
                                               .per_call = per_call_,
                                               .stage = stage},
                          .groups = {groups_for(target.instances, pass_.kernels.group_size)},
                          .writes = {&target.draws}};
        if (stage == CullStage::LastVisible) dispatch.reads = {&target.seen};
        if (stage == CullStage::Unoccluded) {
            dispatch.reads = {&target.depths};
            dispatch.writes = {&target.draws, &target.seen};
        }
        if (target.instances > 0) steps_.push_back(std::move(dispatch));
    }

    void draw(DrawList::Depth depth) {
        const RasterTarget& target = pass_.target;
        steps_.push_back(DrawList{.pipeline = &pass_.kernels.draw,
                                  .arguments = DrawJob{.scene = pass_.scene.record(),
                                                       .view = pass_.view_address,
                                                       .index = index_,
                                                       .cell = cell_},
                                  .ids = &target.ids,
                                  .depth = &target.depth,
                                  .depth_before = depth,
                                  .area = part_.area,
                                  .viewport = cell_.edge,
                                  .draws = &target.draws,
                                  .count = target.instances,
                                  .per_call = per_call_});
    }

    // Levels are stored one after another: first the area itself, down to one pixel.
    void build_depth_pyramid() {
        RasterTarget& target = pass_.target;
        std::vector<PyramidJob> levels;
        std::uint32_t from = 0, end = width() * height();
        for (std::uint32_t w = width(), h = height(); w > 1 || h > 1;) {
            levels.push_back({.from = from, .to = end, .width = w, .height = h});
            w = level_below(w);
            h = level_below(h);
            from = end;
            end += w * h;
        }
        const std::uint64_t bytes = std::uint64_t{end} * sizeof(float);
        if (target.depths.size() < bytes) target.depths = Buffer(pass_.device, bytes);
        steps_.push_back(CopyImage{.from = &target.depth, .area = part_.area, .to = &target.depths});
        for (PyramidJob& level : levels) {
            level.depths = target.depths.address();
            const std::uint32_t items = level_below(level.width) * level_below(level.height);
            steps_.push_back(Dispatch{.pipeline = &pass_.kernels.pyramid,
                                      .arguments = level,
                                      .groups = {groups_for(items, pass_.kernels.group_size)},
                                      .writes = {&target.depths}});
        }
    }

    const RasterPass& pass_;
    std::vector<Step>& steps_;
    const CellPart& part_;
    std::uint64_t index_;
    shading::RasterCell cell_;
    std::uint32_t per_call_;
};

}  // namespace

void RasterPass::add_steps(std::vector<Step>& steps, const Rect& tile, std::uint64_t index,
                           const Buffer& seen, std::uint64_t offset) const {
    const auto row = static_cast<std::uint32_t>(tile.width);
    for (const CellPart& part : cells_of(view, tile)) {
        PartSteps(*this, steps, part, index).add();
        const std::uint64_t first = std::uint64_t(std::int64_t{part.y} + part.area.y - tile.y) * row +
                                    std::uint64_t(std::int64_t{part.x} + part.area.x - tile.x);
        steps.push_back(CopyImage{.from = &target.ids,
                                  .area = part.area,
                                  .to = &seen,
                                  .to_offset = offset + first * target.ids.pixel_bytes(),
                                  .row_pixels = row});
    }
}

}  // namespace tessera::vulkan
