#include "backends/embree/light_record.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace tessera::embree {

using frame::Channel;
using view::FeatureRule;
using view::PathClass;

namespace {

// BT.601, as the thesis' filter was tuned with (Lardinoije 2.2).
float grey(const glm::vec3& color) {
    return glm::dot(color, glm::vec3(0.299f, 0.587f, 0.114f));
}

}  // namespace

glm::vec3 PathSample::irradiance() const {
    glm::vec3 result(0.0f);
    for (int i = 0; i < 3; ++i) {
        if (albedo[i] > 0.0f) result[i] = diffuse[i] / albedo[i];
    }
    return result;
}

float PathSample::shading_feature(FeatureRule rule) const {
    if (rule == FeatureRule::Connections) return connections;
    return grey(irradiance()) + std::fmax(grey(radiance() - diffuse), 0.0f);
}

float PathSample::alpha() const {
    return std::isinf(depth) ? 0.0f : 1.0f;
}

LightRecord::LightRecord(const view::View& view) : path_class_(view.path_class) {
    const bool feature = view.channels.contains(Channel::ShadingFeature);
    keeps_diffuse_ = view.path_class == PathClass::Diffuse || view.channels.contains(Channel::Irradiance) ||
                     (feature && view.feature_rule == FeatureRule::Demodulated);
    keeps_connections_ = feature && view.feature_rule == FeatureRule::Connections;
}

void LightRecord::connect(PathSample& sample, const glm::vec3& intensity) const {
    sample.connections += grey(intensity);
}

}  // namespace tessera::embree
