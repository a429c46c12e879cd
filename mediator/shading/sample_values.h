#ifndef TESSERA_MEDIATOR_SHADING_SAMPLE_VALUES_H
#define TESSERA_MEDIATOR_SHADING_SAMPLE_VALUES_H

#include "mediator/shading/paths.h"

SHADING_BEGIN

// Numbers as in frame/channels.h.
inline constexpr uint ChannelRadiance = 0u, ChannelLowVariance = 1u, ChannelHighVariance = 2u,
                      ChannelAlbedo = 3u, ChannelNormal = 4u, ChannelDepth = 5u, ChannelObjectIndex = 6u,
                      ChannelAlpha = 7u, ChannelHeadlight = 8u, ChannelShadingFeature = 9u,
                      ChannelIrradiance = 10u, ChannelColor = 12u, ChannelRoot = 15u;
// Components of all channels together.
inline constexpr uint MaxSampleValues = 32u;

inline bool has_channel(IN(View) view, uint channel) {
    return ((view.channels >> channel) & 1u) != 0u;
}

// Box-Cox transform of the exponent 1/2, of one component of a sample's radiance: rare bright samples weigh less
// in its moments, which are nearer to those of a normal distribution (Sakai et al. 2024).
inline float root_of(float radiance) {
    return 2.0f * (sqrt(greater_of(radiance, 0.0f)) - 1.0f);
}
inline vec3 root_of(vec3 radiance) {
    return vec3(root_of(radiance.x), root_of(radiance.y), root_of(radiance.z));
}

// Passes the values of a sample, in the order of the channels and only of those that the view requests, to
// store_value(INOUT(Sink), float), which the including file defines with its type of sink.
GENERIC(Sink)
inline void put_number(INOUT(Sink) sink, IN(View) view, uint channel, float value) {
    if (has_channel(view, channel)) store_value(sink, value);
}
GENERIC(Sink)
inline void put_vector(INOUT(Sink) sink, IN(View) view, uint channel, vec3 value) {
    if (!has_channel(view, channel)) return;
    store_value(sink, value.x);
    store_value(sink, value.y);
    store_value(sink, value.z);
}

GENERIC(Sink)
inline void put_sample_values(INOUT(Sink) sink, IN(View) view, IN(PathSample) found) {
    const vec3 radiance = radiance_of(found);
    put_vector(sink, view, ChannelRadiance, radiance);
    put_vector(sink, view, ChannelLowVariance, found.low);
    put_vector(sink, view, ChannelHighVariance, found.high);
    put_vector(sink, view, ChannelAlbedo, found.albedo);
    put_vector(sink, view, ChannelNormal, found.normal);
    put_number(sink, view, ChannelDepth, found.depth);
    put_number(sink, view, ChannelObjectIndex, found.depth);
    put_number(sink, view, ChannelObjectIndex, float_from_bits(found.object));
    put_number(sink, view, ChannelAlpha, found.alpha);
    put_vector(sink, view, ChannelHeadlight, found.headlight);
    put_number(sink, view, ChannelShadingFeature, shading_feature_of(found, view.feature_rule));
    put_vector(sink, view, ChannelIrradiance, irradiance_of(found));
    put_vector(sink, view, ChannelColor, radiance);
    put_vector(sink, view, ChannelRoot, root_of(radiance));
}

#ifdef __cplusplus

// A sink in memory.
struct SampleValues {
    float items[MaxSampleValues];
    uint count = 0u;
};
inline void store_value(SampleValues& values, float value) {
    values.items[values.count++] = value;
}
inline SampleValues sample_values(const View& view, const PathSample& found) {
    SampleValues values;
    put_sample_values(values, view, found);
    return values;
}

#endif

SHADING_END

#endif
