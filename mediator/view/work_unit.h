#pragma once

#include <cstdint>
#include <tuple>

#include "mediator/base/ids.h"
#include "mediator/base/rect.h"
#include "mediator/frame/sample_block.h"

namespace tessera::view {

// One unit of work for a node. The result depends on these values alone; the id only identifies the request.
struct WorkUnit {
    UnitId id;
    ViewId view;
    std::uint64_t revision = 0;  // of the view
    Version version;             // of the scene
    Rect tile;
    frame::SampleBlock block;  // one aligned block of samples for every pixel of the tile
    friend bool operator==(const WorkUnit&, const WorkUnit&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "id", &WorkUnit::id), row(2, "view", &WorkUnit::view),
                          row(3, "revision", &WorkUnit::revision), row(4, "version", &WorkUnit::version),
                          row(5, "tile", &WorkUnit::tile), row(6, "block", &WorkUnit::block));
    }
};

}  // namespace tessera::view
