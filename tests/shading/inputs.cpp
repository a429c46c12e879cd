#include "tests/shading/inputs.h"

#include <initializer_list>
#include <limits>

namespace tessera::shading {

namespace {

constexpr float BelowOne = 0.99999994f;

// Own distributions: those of the standard library differ between libraries.
class Generator {
  public:
    explicit Generator(bool edges) : edges_(edges) {}

    uint bits() { return hash_u32(++state_); }
    bool edge() { return edges_ && bits() % 2u == 0u; }
    float between(float low, float high) { return low + (high - low) * unit_float(bits()); }
    float one_of(std::initializer_list<float> values) { return values.begin()[bits() % values.size()]; }

    float unit() {
        return edge() ? one_of({0.0f, 1e-30f, 0x1p-24f, 1e-4f, 0.25f, 0.5f, 0.75f, 0.9999f, BelowOne})
                      : between(0.0f, 1.0f);
    }
    float share() { return edge() ? one_of({0.0f, 1e-6f, 1.0f}) : between(0.1f, 0.9f); }
    vec3 on_sphere(float z) {
        const float r = std::sqrt(greater_of(0.0f, (1.0f - z) * (1.0f + z)));
        const float angle = edge() ? one_of({0.0f, Pi / 2, Pi}) : between(-Pi, Pi);
        return vec3(r * std::cos(angle), r * std::sin(angle), z);
    }
    vec3 upwards() {
        return on_sphere(edge() ? one_of({1e-12f, 1e-7f, 1e-3f, 0.999f, BelowOne, 1.0f})
                                : between(0.1f, 1.0f));
    }
    float any_size(float exponents) {
        return edge() ? one_of({std::exp2(-exponents), std::exp2(exponents), 1.0f, BelowOne, 1.0000001f})
                      : std::exp2(between(-exponents, exponents));
    }
    float either_sign(float value) { return bits() % 2u == 0u ? value : -value; }

  private:
    bool edges_;
    uint state_ = 0;
};

// Beside the mirrored direction, where lobes of small roughness have their peak.
vec3 near_mirror(const vec3& wo, Generator& random) {
    const float away = random.one_of({0.0f, 1e-6f, 1e-4f, 1e-2f});
    const vec3 direction(-wo.x + away * random.between(-1.0f, 1.0f),
                         -wo.y + away * random.between(-1.0f, 1.0f), wo.z);
    return direction / std::sqrt(dot(direction, direction));
}

Inputs make_input(Generator& random) {
    Inputs x{};
    x.u = vec2(random.unit(), random.unit());
    x.v = vec2(random.unit(), random.unit());
    x.wo = random.upwards();
    x.wi = random.edge() ? near_mirror(x.wo, random) : random.upwards();
    x.n = random.on_sphere(random.either_sign(
        random.edge() ? random.one_of({0.0f, 1e-20f, 1e-7f, BelowOne, 1.0f}) : random.between(0.0f, 1.0f)));
    for (int i = 0; i < 3; ++i) {
        x.vector[i] =
            random.edge() ? random.one_of({0.0f, 1.0f}) : random.either_sign(random.any_size(60.0f));
        x.color[i] = random.share();
    }
    x.angle = random.either_sign(random.edge() ? random.one_of({0.0f, 1e-20f, Pi / 4, Pi / 2, Pi, 1e4f})
                                               : random.between(0.0f, 10.0f));
    x.x = random.either_sign(random.unit());
    x.positive = random.any_size(120.0f);
    x.other = random.any_size(120.0f);
    x.exponent = random.edge() ? random.one_of({-87.0f, 0.0f, 88.0f}) : random.between(-87.0f, 88.0f);
    x.metallic = random.share();
    x.transmission = random.share();
    x.roughness =
        random.edge() ? random.one_of({0.0f, 0.01f, 0.0101f, 0.1f, 1.0f}) : random.between(0.3f, 1.0f);
    x.alpha = greater_of(x.roughness * x.roughness, MinAlpha);
    x.index = random.edge() ? random.one_of({0.0f, 1.0f, 1.0001f, 100.0f}) : random.between(1.2f, 2.5f);
    x.eta = random.edge() ? random.one_of({0.0f, 1.0f, 1e-3f, 0.66f}) : random.between(1.2f, 2.5f);
    x.a = random.edge() ? 0u : random.bits();
    x.b = random.edge() ? 0xffffffffu : random.bits();
    x.c = random.bits();
    x.d = random.bits();
    return x;
}

}  // namespace

std::vector<Inputs> make_inputs(InputSet set, std::size_t count) {
    Generator random(set == InputSet::Edges);
    std::vector<Inputs> inputs;
    for (std::size_t i = 0; i < count; ++i) inputs.push_back(make_input(random));
    return inputs;
}

}  // namespace tessera::shading
