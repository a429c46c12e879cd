#ifndef TESSERA_MEDIATOR_SHADING_SAMPLE_VALUES_H
#define TESSERA_MEDIATOR_SHADING_SAMPLE_VALUES_H

#include "mediator/shading/paths.h"

SHADING_BEGIN

// Numbers as in frame/channels.h.
inline constexpr uint ChannelRadiance = 0u, ChannelLowVariance = 1u, ChannelHighVariance = 2u,
                      ChannelAlbedo = 3u, ChannelNormal = 4u, ChannelDepth = 5u, ChannelObjectIndex = 6u,
                      ChannelAlpha = 7u, ChannelRange = 8u, ChannelShadingFeature = 9u,
                      ChannelIrradiance = 10u, ChannelEvenHalf = 11u;
// Components of all channels together.
inline constexpr uint MaxSampleValues = 30u;

// The values of a sample in the order of the channels, only of those that the view asks for.
struct SampleValues {
    float items[MaxSampleValues];
    uint count;
};

inline bool has_channel(IN(View) view, uint channel) {
    return ((view.channels >> channel) & 1u) != 0u;
}
inline void put_number(INOUT(SampleValues) values, IN(View) view, uint channel, float value) {
    if (!has_channel(view, channel)) return;
    values.items[values.count] = value;
    values.count += 1u;
}
inline void put_vector(INOUT(SampleValues) values, IN(View) view, uint channel, vec3 value) {
    put_number(values, view, channel, value.x);
    put_number(values, view, channel, value.y);
    put_number(values, view, channel, value.z);
}

// `index`: of the sample; only whether it is even counts.
inline SampleValues sample_values(IN(View) view, IN(PathSample) found, uint index) {
    SampleValues values;
    values.count = 0u;
    const vec3 radiance = radiance_of(found);
    put_vector(values, view, ChannelRadiance, radiance);
    put_vector(values, view, ChannelLowVariance, found.low);
    put_vector(values, view, ChannelHighVariance, found.high);
    put_vector(values, view, ChannelAlbedo, found.albedo);
    put_vector(values, view, ChannelNormal, found.normal);
    put_number(values, view, ChannelDepth, found.depth);
    put_number(values, view, ChannelObjectIndex, found.depth);
    put_number(values, view, ChannelObjectIndex, float_from_bits(found.object));
    put_number(values, view, ChannelAlpha, alpha_of(found));
    put_vector(values, view, ChannelRange, found.range);
    put_number(values, view, ChannelShadingFeature, shading_feature_of(found, view.feature_rule));
    put_vector(values, view, ChannelIrradiance, irradiance_of(found));
    const bool even = index % 2u == 0u;
    put_vector(values, view, ChannelEvenHalf, even ? radiance : vec3(0.0f));
    put_number(values, view, ChannelEvenHalf, even ? 1.0f : 0.0f);
    return values;
}

SHADING_END

#endif
