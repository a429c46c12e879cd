#include "backends/vulkan/unit_film.h"

#include <algorithm>
#include <array>
#include <bit>

#include "mediator/frame/merge.h"
#include "mediator/shading/sample_values.h"

namespace tessera::vulkan {

std::uint32_t value_count(frame::ChannelSet channels) {
    std::uint32_t count = 0;
    for (const frame::ChannelInfo& info : frame::channel_table()) {
        if (channels.contains(info.channel)) count += info.value_count();
    }
    return count;
}

UnitFilm::UnitFilm(const view::WorkUnit& unit, frame::ChannelSet channels)
    : unit_(unit), pixels_(unit.pixels().value()), channels_(channels), values_(value_count(channels)) {
    begin(unit.block.first);
}

void UnitFilm::begin(std::uint64_t sample) {
    if (sample < unit_.block.end()) tile_ = finished_.recycled(unit_.tile, {sample, 0}, channels_, pixels_);
    pixel_ = 0;
}

void UnitFilm::add(std::span<const float> values, std::uint32_t count) {
    std::array<float, shading::MaxSampleValues> item{};
    for (std::uint32_t i = 0; i < count; ++i) {
        for (std::uint32_t k = 0; k < values_; ++k) item[k] = values[std::size_t{k} * count + i];
        rays_ += std::bit_cast<std::uint32_t>(values[std::size_t{values_} * count + i]);
        frame::put_sample(tile_, pixel_, std::span(item).first(values_));
        if (++pixel_ == tile_.pixel_count()) {
            const std::uint64_t next = tile_.block.first + 1;
            finished_.push(std::move(tile_));
            begin(next);
        }
    }
}

void UnitFilm::add_block(std::span<const float> planes, frame::SampleBlock block) {
    tile_.block = block;
    std::ranges::fill(tile_.counts, static_cast<std::uint32_t>(block.count()));
    std::ranges::copy(planes.first(tile_.planes.size()), tile_.planes.begin());
    for (const float rays : planes.subspan(tile_.planes.size(), tile_.pixel_count())) {
        rays_ += std::bit_cast<std::uint32_t>(rays);
    }
    finished_.push(std::move(tile_));
    begin(block.end());
}

backend::RenderResult UnitFilm::take(backend::RenderStatus status) {
    return {.status = status, .blocks = finished_.take(), .rays = rays_};
}

}  // namespace tessera::vulkan
