#pragma once

#include <cstdint>
#include <span>

#include "mediator/backend/backend.h"
#include "mediator/frame/block_stack.h"

namespace tessera::vulkan {

// The number of floats per sample.
std::uint32_t value_count(frame::ChannelSet channels);

// The film of a unit, filled in the order of its samples: by single ones, or by merged blocks of all its
// pixels. The unit outlives it.
class UnitFilm {
  public:
    UnitFilm(const view::WorkUnit& unit, frame::ChannelSet channels);

    // values[k * count + i]: value k of item i, which is the next sample of the next pixel; after the values
    // the ray count, as bits.
    void add(std::span<const float> values, std::uint32_t count);

    // `planes`: those of a film tile and one of ray counts, as bits. Only at the start of a sample.
    void add_block(std::span<const float> planes, frame::SampleBlock block);

    // Drops an incomplete sample.
    backend::RenderResult take(backend::RenderStatus status);

  private:
    void begin(std::uint64_t sample);

    const view::WorkUnit& unit_;
    frame::PixelSet pixels_;
    frame::ChannelSet channels_;
    std::uint32_t values_;
    frame::BlockStack finished_;
    frame::FilmTile tile_;
    std::size_t pixel_ = 0;
    std::uint64_t rays_ = 0;
};

}  // namespace tessera::vulkan
