#include "backends/vulkan/merge_columns.h"

namespace tessera::vulkan {

namespace {

ColumnRule column_rule(frame::MergeRule rule) {
    switch (rule) {
        case frame::MergeRule::Moments:
            return ColumnRule::Moments;
        case frame::MergeRule::Sum:
            return ColumnRule::Sum;
        case frame::MergeRule::Minimum:
            return ColumnRule::Minimum;
        case frame::MergeRule::Maximum:
            return ColumnRule::Maximum;
        case frame::MergeRule::Nearest:
            return ColumnRule::Nearest;
        case frame::MergeRule::First:
            return ColumnRule::First;
        case frame::MergeRule::BlockVariance:
            return ColumnRule::BlockVariance;
        case frame::MergeRule::FirstHalf:
            return ColumnRule::FirstHalf;
    }
    return ColumnRule::First;
}

}  // namespace

std::vector<MergeColumn> merge_columns(frame::ChannelSet channels) {
    std::vector<MergeColumn> columns;
    std::uint32_t value = 0, plane = 0;
    for (const frame::ChannelInfo& info : frame::channel_table()) {
        if (!channels.contains(info.channel)) continue;
        const ColumnRule rule = column_rule(info.rule);
        if (info.is_derived()) {
            // Radiance is the first channel.
            columns.push_back({rule, 0, info.components, plane});
            plane += info.plane_count();
            continue;
        }
        const bool is_record = rule == ColumnRule::Nearest || rule == ColumnRule::First;
        for (std::uint32_t c = 0; c < (is_record ? 1u : info.components); ++c) {
            // Columns of one value each, except for records.
            const bool one_by_one = rule == ColumnRule::Minimum || rule == ColumnRule::Maximum;
            columns.push_back({rule, value + c, one_by_one ? 1u : info.components, plane + c});
        }
        value += info.value_count();
        plane += info.plane_count();
    }
    columns.push_back({ColumnRule::Count, value, 1, plane});
    return columns;
}

}  // namespace tessera::vulkan
