#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>

#include "mediator/base/ids.h"
#include "mediator/base/rect.h"
#include "mediator/frame/pixel_set.h"
#include "mediator/frame/sample_block.h"

namespace tessera::view {

// One unit of work for a node. The result depends on these values alone; the id only identifies the request.
struct WorkUnit {
    UnitId id;
    ViewId view;
    std::uint64_t revision = 0;  // of the view
    Version version;             // of the scene
    Rect tile;
    frame::SampleBlock block;  // one aligned block of samples for each pixel
    std::string mask;          // of pixels of the tile, see frame::PixelSet::from_bits(); empty: all

    // Nothing: the mask does not fit the tile.
    std::optional<frame::PixelSet> pixels() const {
        return frame::PixelSet::from_bits(mask, tile.pixel_count());
    }
    std::size_t pixel_count() const {
        if (mask.empty()) return tile.pixel_count();
        std::size_t count = 0;
        for (const char byte : mask)
            count += static_cast<std::size_t>(std::popcount(static_cast<std::uint8_t>(byte)));
        return count;
    }
    std::uint64_t pixel_samples() const { return block.count() * pixel_count(); }
    friend bool operator==(const WorkUnit&, const WorkUnit&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "id", &WorkUnit::id), row(2, "view", &WorkUnit::view),
                          row(3, "revision", &WorkUnit::revision), row(4, "version", &WorkUnit::version),
                          row(5, "tile", &WorkUnit::tile), row(6, "block", &WorkUnit::block),
                          row(7, "mask", &WorkUnit::mask));
    }
    const char* malformed() const { return pixels() ? nullptr : "the mask of a unit does not fit its tile"; }
};

}  // namespace tessera::view
