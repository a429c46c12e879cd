#pragma once

#include <cstdint>
#include <vector>

#include "mediator/frame/channels.h"

namespace tessera::vulkan {

// How shaders/merge.comp combines the values of the samples of a pixel: frame::MergeRule, or an integer sum.
enum class ColumnRule : std::uint32_t {
    Moments,
    Sum,
    Minimum,
    Maximum,
    Nearest,
    First,
    Count,
    BlockVariance,
    FirstHalf
};

// Values that are merged together: `components` of them from the one numbered `value` on become planes from
// `plane` on. Values of Moments and Sum are merged one by one: `components` is then the offset from
// the plane of the mean to the plane of M2. Derived channels are computed from the three values of radiance, at `value`.
struct MergeColumn {
    ColumnRule rule = ColumnRule::Count;
    std::uint32_t value = 0, components = 1, plane = 0;
};
static_assert(sizeof(MergeColumn) == 16);

// The columns of a sample's values, and of the count of rays behind them: planes as in a film tile, and one
// for the rays.
std::vector<MergeColumn> merge_columns(frame::ChannelSet channels);

}  // namespace tessera::vulkan
