#pragma once

#include <array>
#include <span>

#include "backends/embree/light_record.h"

namespace tessera::embree {

// The values of a sample in the order of the channels, as frame::put_sample wants them; only those that are
// asked for.
class SampleValues {
  public:
    explicit SampleValues(const view::View& view) : channels_(view.channels), rule_(view.feature_rule) {}

    // Valid until the next call.
    std::span<const float> of(const PathSample& sample, std::uint64_t index);

  private:
    void add(frame::Channel channel, float value);
    void add(frame::Channel channel, const glm::vec3& value);

    frame::ChannelSet channels_;
    view::FeatureRule rule_;
    std::array<float, 32> values_{};
    std::size_t count_ = 0;
};

}  // namespace tessera::embree
