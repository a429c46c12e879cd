#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "mediator/view/view.h"

namespace tessera::embree {

// What one sample found. Radiance is low + high, so that its bits do not depend on the channels asked for.
struct PathSample {
    glm::vec3 low{0.0f}, high{0.0f};  // light outside and inside the view's path class
    glm::vec3 diffuse{0.0f};          // of it, by the diffuse lobe of the first non-delta hit; where needed
    float connections = 0.0f;         // grey intensity of the lights that were reached; where needed
    glm::vec3 albedo{0.0f};           // of the first non-delta hit times the weight of the way to it
    glm::vec3 normal{0.0f};           // of the first non-delta hit
    glm::vec3 range{0.0f};            // head light and ambient (Schwenk 2A.3); where asked for
    float depth = 0.0f;               // of the first hit, along the view axis; +inf: nothing hit
    std::uint32_t object = 0;         // of the first hit

    glm::vec3 radiance() const { return low + high; }
    glm::vec3 irradiance() const;  // diffuse light without the albedo; 0 where that is 0
    float shading_feature(view::FeatureRule rule) const;  // Lardinoije 2.2
    float alpha() const;
};

// All that decides for which channels the light of a path counts.
struct Way {
    std::uint32_t scatterings = 0;  // between light and eye, from the first non-delta hit on
    enum class Last : std::uint8_t { NonDelta, Delta } last = Last::NonDelta;  // of all, next to the light
    glm::vec3 diffuse_share{
        0.0f};  // of its light: what the diffuse lobe of the first non-delta hit passed on
};

// Sorts light into a sample's path classes, as the view asks for.
class LightRecord {
  public:
    explicit LightRecord(const view::View& view);

    bool keeps_diffuse() const { return keeps_diffuse_; }  // else Way::diffuse_share is not read
    bool keeps_connections() const { return keeps_connections_; }

    void add(PathSample& sample, const glm::vec3& light, const Way& way) const;
    // A light that a path reaches, by its own intensity; only where connections are kept.
    void connect(PathSample& sample, const glm::vec3& intensity) const;

  private:
    view::PathClass path_class_;
    bool keeps_diffuse_, keeps_connections_;
};

// Here, since it is called for every light found.
inline void LightRecord::add(PathSample& sample, const glm::vec3& light, const Way& way) const {
    const glm::vec3 diffuse = keeps_diffuse_ ? light * way.diffuse_share : glm::vec3(0.0f);
    sample.diffuse += diffuse;
    bool high = false;
    switch (path_class_) {
        case view::PathClass::Indirect:
            high = way.scatterings > 1;
            break;
        case view::PathClass::Caustics:
            high = way.scatterings > 1 && way.last == Way::Last::Delta;
            break;
        case view::PathClass::Diffuse:
            sample.high += diffuse;
            sample.low += light - diffuse;
            return;
        case view::PathClass::All:
            high = true;
            break;
        case view::PathClass::None:
            break;
    }
    (high ? sample.high : sample.low) += light;
}

}  // namespace tessera::embree
