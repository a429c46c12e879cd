#include "backends/vulkan/tile_renderer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>

#include "backends/vulkan/device/transfer.h"
#include "backends/vulkan/job.h"
#include "mediator/frame/block_stack.h"
#include "mediator/frame/merge.h"
#include "mediator/shading/sample_values.h"

namespace tessera::vulkan {

namespace {

std::uint32_t value_count(frame::ChannelSet channels) {
    std::uint32_t count = 0;
    for (const frame::ChannelInfo& info : frame::channel_table()) {
        if (channels.contains(info.channel)) count += info.components;
    }
    return count;
}

// The film of a unit, filled by items in their order.
class UnitFilm {
  public:
    UnitFilm(const view::WorkUnit& unit, frame::ChannelSet channels) : unit_(unit), channels_(channels) {
        begin(unit.block.first);
    }

    // values[k * count + i]: value k of item i.
    void add(std::span<const float> values, std::uint32_t count, std::uint32_t value_count) {
        std::array<float, shading::MaxSampleValues> item{};
        for (std::uint32_t i = 0; i < count; ++i) {
            for (std::uint32_t k = 0; k < value_count; ++k) item[k] = values[std::size_t{k} * count + i];
            result.rays += std::bit_cast<std::uint32_t>(values[std::size_t{value_count} * count + i]);
            frame::put_sample(tile_, pixel_, std::span(item).first(value_count));
            if (++pixel_ == tile_.pixel_count()) {
                const std::uint64_t next = tile_.block.first + 1;
                finished_.push(std::move(tile_));
                begin(next);
            }
        }
    }
    backend::RenderResult take(backend::RenderStatus status) {
        result.status = status;
        result.blocks = finished_.take();  // a sample that is not whole is dropped
        return std::move(result);
    }

  private:
    void begin(std::uint64_t sample) {
        if (sample < unit_.block.end()) tile_ = finished_.recycled(unit_.tile, {sample, 0}, channels_);
        pixel_ = 0;
    }

    const view::WorkUnit& unit_;
    frame::ChannelSet channels_;
    frame::BlockStack finished_;
    frame::FilmTile tile_;
    std::size_t pixel_ = 0;
    backend::RenderResult result;
};

// One dispatch on its way.
struct Batch {
    Buffer values;
    Submission submission;
    std::uint32_t items = 0;
};

}  // namespace

backend::RenderResult TileRenderer::run(const shading::View& view, const view::WorkUnit& unit,
                                        frame::ChannelSet channels, const std::stop_token& stop) const {
    const auto pixels = static_cast<std::uint32_t>(unit.tile.pixel_count());
    const std::uint32_t values = value_count(channels), planes = values + 1;
    const std::uint64_t samples = unit.block.end() - unit.block.first;
    const Buffer view_buffer = make_buffer(device, std::vector<shading::View>{view});
    const bool fits_texels = scene.pool().size() / 16 <= device.info().texel_elements;
    const bool trees = view.renderer == shading::RendererWhitted || (view.keeps & shading::KeepsRange) != 0;
    const ComputePipeline& kernel = kernels.find({scene.features(), trees, fits_texels});

    UnitFilm film(unit, channels);
    std::array<Batch, 2> batches;
    std::uint64_t sent = 0;  // items
    const std::uint64_t all = samples * pixels;
    const auto send = [&](Batch& batch) {
        batch.items = static_cast<std::uint32_t>(std::min<std::uint64_t>(pace.samples(), all - sent));
        if (batch.items == 0) return;
        const std::uint64_t bytes = std::uint64_t{planes} * batch.items * sizeof(float);
        if (batch.values.size() < bytes) batch.values = Buffer(device, bytes, MemoryKind::Readback);
        Pass pass{.pipeline = &kernel,
                  .arguments = Job{.scene = scene.record(),
                                   .view = view_buffer.address(),
                                   .pool = scene.pool().address(),
                                   .values = batch.values.address(),
                                   .first_sample = unit.block.first + sent / pixels,
                                   .top = scene.top(),
                                   .x = static_cast<std::uint32_t>(unit.tile.x),
                                   .y = static_cast<std::uint32_t>(unit.tile.y),
                                   .width = static_cast<std::uint32_t>(unit.tile.width),
                                   .pixels = pixels,
                                   .first_item = static_cast<std::uint32_t>(sent % pixels),
                                   .item_count = batch.items},
                  .groups = {(batch.items + kernels.group_size() - 1) / kernels.group_size()},
                  .writes = {&batch.values}};
        if (fits_texels) pass.bound = {&scene.pool()};
        batch.submission = device.queue().submit(Step(pass), Timing::Total);
        sent += batch.items;
    };
    for (Batch& batch : batches) send(batch);
    for (std::size_t turn = 0; batches[turn].items > 0; turn = 1 - turn) {
        Batch& batch = batches[turn];
        // What still runs is abandoned: a first dispatch may wait for the driver's compiler.
        while (!batch.submission.wait_for(std::chrono::milliseconds(5)) && !stop.stop_requested()) {
        }
        if (stop.stop_requested()) return film.take(backend::RenderStatus::Stopped);
        const std::vector<double> seconds = batch.submission.seconds();
        if (!seconds.empty()) pace.learn(batch.items, seconds.front());
        const auto bytes = batch.values.mapped();
        const std::span found(reinterpret_cast<const float*>(bytes.data()), bytes.size() / sizeof(float));
        film.add(found, batch.items, values);
        send(batch);
    }
    return film.take(backend::RenderStatus::Done);
}

}  // namespace tessera::vulkan
