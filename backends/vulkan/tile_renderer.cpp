#include "backends/vulkan/tile_renderer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <optional>

#include "backends/vulkan/device/transfer.h"
#include "backends/vulkan/job.h"
#include "backends/vulkan/merge_columns.h"
#include "backends/vulkan/unit_film.h"

namespace tessera::vulkan {

namespace {

// One dispatch in flight: individual samples, or whole samples of all its pixels that are merged after it.
struct Batch {
    Buffer values;   // of the samples, readable by the host
    Buffer scratch;  // the same for samples that are merged
    Buffer merged;   // planes, ray counts, and a word that is not 0 if the host has to merge
    Submission submission;
    std::uint32_t items = 0;
    std::optional<frame::SampleBlock> block;
};

void ensure_size(Device& device, Buffer& buffer, std::uint64_t bytes, MemoryKind kind) {
    if (buffer.size() < bytes) buffer = Buffer(device, bytes, kind);
}

// False: stopped before the kernel was compiled.
bool ready(const Kernel& kernel, const std::stop_token& stop) {
    while (kernel.wait_for(std::chrono::milliseconds(5)) != std::future_status::ready) {
        if (stop.stop_requested()) return false;
    }
    return true;
}

// The block of the next dispatch: the largest that can be merged on the device, if any.
std::optional<frame::SampleBlock> next_block(std::uint64_t sample, std::uint64_t end, std::uint64_t most) {
    if (most < 2 || end - sample < 2) return std::nullopt;
    const int aligned = sample == 0 ? 63 : std::countr_zero(sample);
    const int fits = static_cast<int>(std::bit_width(std::min(end - sample, most))) - 1;
    const int level = std::min({aligned, fits, MaxMergedLevel});
    if (level == 0) return std::nullopt;
    return frame::SampleBlock{sample, static_cast<std::uint32_t>(level)};
}

// Renders one unit.
class UnitRun {
  public:
    UnitRun(const TileRenderer& with, shading::View view, const view::WorkUnit& unit,
            frame::ChannelSet channels)
        : device_(with.device),
          kernels_(with.kernels),
          dispatch_budget_(with.dispatch_budget),
          scene_(with.scene),
          unit_(unit),
          rendered_(unit.pixels().value()),
          pixels_(static_cast<std::uint32_t>(rendered_.count(unit.tile.pixel_count()))),
          values_(value_count(channels)),
          planes_(channels.plane_count()),
          all_(unit.block.count() * pixels_),
          film_(unit, channels) {
        if (!with.camera_keys.empty()) {
            camera_keys_ = make_buffer(device_, with.camera_keys);
            view.camera_keys.items = reinterpret_cast<const shading::Affine3x4*>(camera_keys_.address());
        }
        view_ = make_buffer(device_, std::vector<shading::View>{view});
        if (!rendered_.is_all()) {
            const std::span<const std::uint32_t> indices = rendered_.indices();
            indices_ = make_buffer(device_, std::vector<std::uint32_t>(indices.begin(), indices.end()));
        }
        const bool trees = view.renderer == shading::RendererWhitted ||
                           view.renderer == shading::RendererRaster ||
                           (view.recorded_quantities & shading::RecordsHeadlight) != 0;
        kernel_ = kernels_.find({.features = with.features,
                                 .specular_trees = trees,
                                 .rasterised = with.raster != nullptr,
                                 .traversal = scene_.traversal()});
        if (with.raster != nullptr) {
            raster_.emplace(device_, *with.raster, scene_, view, view_.address(), unit.tile);
        }
        merges_ = unit.block.level > 0 && device_.info().supports_round_to_even;
        if (merges_) {
            const std::vector<MergeColumn> columns = merge_columns(channels);
            column_count_ = static_cast<std::uint32_t>(columns.size());
            columns_ = make_buffer(device_, columns);
            merge_kernel_ = kernels_.merge_kernel();
        }
    }

    backend::RenderResult run(const std::stop_token& stop) {
        if (!ready(kernel_, stop) || (merges_ && !ready(merge_kernel_, stop))) {
            return film_.take(backend::RenderStatus::Stopped);
        }
        std::array<Batch, 2> batches;
        for (Batch& batch : batches) send(batch);
        for (std::size_t turn = 0; batches[turn].items > 0; turn = 1 - turn) {
            Batch& batch = batches[turn];
            // Running dispatches are abandoned: a first one may wait for the driver's compiler.
            while (!batch.submission.wait_for(std::chrono::milliseconds(5)) && !stop.stop_requested()) {
            }
            if (stop.stop_requested()) return film_.take(backend::RenderStatus::Stopped);
            const std::vector<double> seconds = batch.submission.seconds();
            if (!seconds.empty()) dispatch_budget_.update(batch.items, seconds.front());
            receive(batch);
            send(batch);
        }
        return film_.take(backend::RenderStatus::Done);
    }

  private:
    void send(Batch& batch) {
        const std::uint64_t begun = sent_ % pixels_;
        std::uint64_t most = dispatch_budget_.samples();
        if (raster_) most = std::min(most, std::uint64_t{RasterRun::MaxSamples} * pixels_);
        batch.block.reset();
        if (merges_ && begun == 0 && sent_ < all_) {
            batch.block = next_block(unit_.block.first + sent_ / pixels_, unit_.block.end(), most / pixels_);
        }
        std::uint64_t items = std::min(most, all_ - sent_);
        if (batch.block) items = batch.block->count() * pixels_;
        // Up to the end of a sample, after which blocks can be merged.
        if (merges_ && begun != 0 && most >= 2 * std::uint64_t{pixels_}) items = pixels_ - begun;
        if (raster_) items = of_whole_draws(items, begun);
        batch.items = static_cast<std::uint32_t>(items);
        if (items == 0) return;
        const std::uint64_t bytes = (std::uint64_t{values_} + 1) * items * sizeof(float);
        Buffer& values = batch.block ? batch.scratch : batch.values;
        ensure_size(device_, values, bytes, batch.block ? MemoryKind::Device : MemoryKind::Readback);
        std::vector<Step> steps;
        if (raster_ && begun == 0) {
            const auto samples = static_cast<std::uint32_t>((items + pixels_ - 1) / pixels_);
            raster_->draw(steps, unit_.block.first + sent_ / pixels_, samples);
        }
        steps.emplace_back(trace_dispatch(values, batch.items));
        if (batch.block) {
            const std::uint64_t words = (std::uint64_t{planes_} + 1) * pixels_ + 1;
            ensure_size(device_, batch.merged, words * sizeof(float), MemoryKind::Readback);
            steps.emplace_back(
                Fill{.buffer = &batch.merged, .offset = (words - 1) * sizeof(float), .bytes = sizeof(float)});
            steps.emplace_back(merge_dispatch(batch));
        }
        batch.submission = device_.queue().submit(steps, Timing::Total);
        sent_ += items;
    }

    // Rasterises whole samples: dispatches end at the end of a drawn batch.
    std::uint64_t of_whole_draws(std::uint64_t items, std::uint64_t begun) const {
        if (begun != 0) return std::min(items, pixels_ - begun);
        return items > pixels_ ? items / pixels_ * pixels_ : items;
    }

    Dispatch trace_dispatch(const Buffer& values, std::uint32_t items) const {
        Dispatch dispatch{
            .pipeline = &kernel_.get(),
            .arguments = Job{.scene = scene_.record(),
                             .view = view_.address(),
                             .pool = scene_.pool().address(),
                             .values = values.address(),
                             .first_sample = unit_.block.first + sent_ / pixels_,
                             .top = scene_.top(),
                             .x = static_cast<std::uint32_t>(unit_.tile.x),
                             .y = static_cast<std::uint32_t>(unit_.tile.y),
                             .width = static_cast<std::uint32_t>(unit_.tile.width),
                             .pixels = pixels_,
                             .first_item = static_cast<std::uint32_t>(sent_ % pixels_),
                             .item_count = items,
                             .tile_pixels = static_cast<std::uint32_t>(unit_.tile.pixel_count()),
                             .seen = raster_ ? raster_->seen().address() : 0,
                             .indices = rendered_.is_all() ? 0 : indices_.address()},
            .groups = {groups_of(items)},
            .writes = {&values}};
        if (raster_) dispatch.reads = {&raster_->seen()};
        if (scene_.traversal() == Traversal::Texels) dispatch.bound = {&scene_.pool()};
        return dispatch;
    }

    Dispatch merge_dispatch(const Batch& batch) const {
        return {.pipeline = &merge_kernel_.get(),
                .arguments = MergeJob{.columns = columns_.address(),
                                      .values = batch.scratch.address(),
                                      .planes = batch.merged.address(),
                                      .pixels = pixels_,
                                      .level = batch.block->level,
                                      .column_count = column_count_,
                                      .plane_count = planes_ + 1},
                .groups = {groups_of(pixels_ * column_count_)},
                .reads = {&batch.scratch},
                .writes = {&batch.merged}};
    }

    std::uint32_t groups_of(std::uint32_t invocations) const {
        return (invocations + kernels_.group_size() - 1) / kernels_.group_size();
    }

    void receive(const Batch& batch) {
        if (!batch.block) return film_.add(floats_in(batch.values.mapped()), batch.items);
        const std::span planes = floats_in(batch.merged.mapped());
        const std::size_t flag = (std::size_t{planes_} + 1) * pixels_;
        if (std::bit_cast<std::uint32_t>(planes[flag]) == 0) {
            film_.add_block(planes.first(flag), *batch.block);
        } else {
            film_.add(download<float>(device_, batch.scratch), batch.items);
        }
    }

    static std::span<const float> floats_in(std::span<const std::byte> bytes) {
        return {reinterpret_cast<const float*>(bytes.data()), bytes.size() / sizeof(float)};
    }

    Device& device_;
    Kernels& kernels_;
    DispatchBudget& dispatch_budget_;
    const GpuScene& scene_;
    const view::WorkUnit& unit_;
    frame::PixelSet rendered_;
    std::uint32_t pixels_, values_, planes_;
    std::uint64_t all_, sent_ = 0;  // items
    Buffer camera_keys_, view_, columns_, indices_;
    std::uint32_t column_count_ = 0;
    bool merges_ = false;
    Kernel kernel_, merge_kernel_;
    UnitFilm film_;
    std::optional<RasterRun> raster_;
};

}  // namespace

backend::RenderResult TileRenderer::run(const shading::View& view, const view::WorkUnit& unit,
                                        frame::ChannelSet channels, const std::stop_token& stop) const {
    return UnitRun(*this, view, unit, channels).run(stop);
}

}  // namespace tessera::vulkan
