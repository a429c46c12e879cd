#pragma once

#include <cstdint>
#include <vector>

#include "mediator/frame/channels.h"

namespace tessera::vulkan {

// What shaders/merge.comp makes of the values of a pixel's samples: frame::MergeRule, or the sum of whole
// numbers.
enum class ColumnRule : std::uint32_t { Moments, Sum, Minimum, Maximum, Nearest, First, Count };

// Values that are merged together: `components` of them from the one numbered `value` on become planes from
// `plane` on. Values of Moments and Sum are merged one by one: `components` is then how far the plane of M2
// lies behind the one of the mean.
struct MergeColumn {
    ColumnRule rule = ColumnRule::Count;
    std::uint32_t value = 0, components = 1, plane = 0;
};
static_assert(sizeof(MergeColumn) == 16);

// The columns of a sample's values, and of the count of rays behind them: planes as in a film tile, and one
// for the rays.
std::vector<MergeColumn> merge_columns(frame::ChannelSet channels);

}  // namespace tessera::vulkan
