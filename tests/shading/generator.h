#pragma once

#include <cmath>
#include <initializer_list>

#include "mediator/shading/maths.h"
#include "mediator/shading/sampler.h"

namespace tessera::shading {

// Random numbers; with `edges` half of the draws are edge cases. Own distributions, since those of the
// standard library differ between implementations.
class Generator {
  public:
    explicit Generator(bool edges) : edges_(edges) {}

    uint bits() { return hash_u32(++state_); }
    bool edge() { return edges_ && bits() % 2u == 0u; }
    float between(float low, float high) { return low + (high - low) * unit_float(bits()); }
    float one_of(std::initializer_list<float> values) { return values.begin()[bits() % values.size()]; }

    // In [0, 1).
    float unit() {
        return edge() ? one_of({0.0f, 1e-30f, 0x1p-24f, 1e-4f, 0.25f, 0.5f, 0.75f, 0.9999f, BelowOne})
                      : between(0.0f, 1.0f);
    }
    float random_fraction() { return edge() ? one_of({0.0f, 1e-6f, 1.0f}) : between(0.1f, 0.9f); }
    vec3 color() { return vec3(random_fraction(), random_fraction(), random_fraction()); }
    vec3 on_sphere(float z) {
        const float r = std::sqrt(greater_of(0.0f, (1.0f - z) * (1.0f + z)));
        const float angle = edge() ? one_of({0.0f, Pi / 2, Pi}) : between(-Pi, Pi);
        return vec3(r * std::cos(angle), r * std::sin(angle), z);
    }
    vec3 upwards() {
        return on_sphere(edge() ? one_of({1e-12f, 1e-7f, 1e-3f, 0.999f, BelowOne, 1.0f})
                                : between(0.1f, 1.0f));
    }
    vec3 anywhere() {
        return on_sphere(
            either_sign(edge() ? one_of({0.0f, 1e-20f, 1e-7f, BelowOne, 1.0f}) : between(0.0f, 1.0f)));
    }
    // Near the mirrored direction, where lobes of low roughness peak.
    vec3 near_mirror(vec3 wo) {
        const float away = one_of({0.0f, 1e-6f, 1e-4f, 1e-2f});
        const vec3 direction(-wo.x + away * between(-1.0f, 1.0f), -wo.y + away * between(-1.0f, 1.0f), wo.z);
        return direction / std::sqrt(dot(direction, direction));
    }
    float any_size(float exponents) {
        return edge() ? one_of({std::exp2(-exponents), std::exp2(exponents), 1.0f, BelowOne, 1.0000001f})
                      : std::exp2(between(-exponents, exponents));
    }
    float either_sign(float value) { return bits() % 2u == 0u ? value : -value; }

  private:
    static constexpr float BelowOne = 0.99999994f;

    bool edges_;
    uint state_ = 0;
};

}  // namespace tessera::shading
