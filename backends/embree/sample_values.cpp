#include "backends/embree/sample_values.h"

#include <bit>

namespace tessera::embree {

using frame::Channel;

void SampleValues::add(Channel channel, float value) {
    if (channels_.contains(channel)) values_[count_++] = value;
}

void SampleValues::add(Channel channel, const glm::vec3& value) {
    for (int i = 0; i < 3; ++i) add(channel, value[i]);
}

std::span<const float> SampleValues::of(const PathSample& sample, std::uint64_t index) {
    count_ = 0;
    const glm::vec3 radiance = sample.radiance();
    add(Channel::Radiance, radiance);
    add(Channel::LowVariance, sample.low);
    add(Channel::HighVariance, sample.high);
    add(Channel::Albedo, sample.albedo);
    add(Channel::Normal, sample.normal);
    add(Channel::Depth, sample.depth);
    if (channels_.contains(Channel::ObjectIndex)) {
        values_[count_++] = sample.depth;
        values_[count_++] = std::bit_cast<float>(sample.object);
    }
    add(Channel::Alpha, sample.alpha());
    add(Channel::Range, sample.range);
    if (channels_.contains(Channel::ShadingFeature))
        add(Channel::ShadingFeature, sample.shading_feature(rule_));
    if (channels_.contains(Channel::Irradiance)) add(Channel::Irradiance, sample.irradiance());
    const bool even = index % 2 == 0;
    add(Channel::EvenHalf, even ? radiance : glm::vec3(0.0f));
    add(Channel::EvenHalf, even ? 1.0f : 0.0f);
    return {values_.data(), count_};
}

}  // namespace tessera::embree
