#include "tests/shading/inputs.h"

#include "tests/shading/generator.h"

namespace tessera::shading {

namespace {

Inputs make_input(Generator& random) {
    Inputs x{};
    x.u = vec2(random.unit(), random.unit());
    x.v = vec2(random.unit(), random.unit());
    x.weights = random.edge() ? vec2(random.one_of({0.0f, 0.5f}), random.one_of({0.0f, 0.5f}))
                              : vec2(random.between(0.05f, 0.45f), random.between(0.05f, 0.45f));
    x.wo = random.upwards();
    x.wi = random.edge() ? random.near_mirror(x.wo) : random.upwards();
    x.n = random.anywhere();
    for (int i = 0; i < 3; ++i) {
        x.vector[i] =
            random.edge() ? random.one_of({0.0f, 1.0f}) : random.either_sign(random.any_size(60.0f));
    }
    x.color = random.color();
    x.light = random.color();
    x.angle = random.either_sign(random.edge() ? random.one_of({0.0f, 1e-20f, Pi / 4, Pi / 2, Pi, 1e4f})
                                               : random.between(0.0f, 10.0f));
    x.x = random.either_sign(random.unit());
    x.positive = random.any_size(120.0f);
    x.other = random.any_size(120.0f);
    x.pdf = random.any_size(10.0f);
    x.exponent = random.edge() ? random.one_of({-87.0f, 0.0f, 88.0f}) : random.between(-87.0f, 88.0f);
    x.metallic = random.random_fraction();
    x.transmission = random.random_fraction();
    x.roughness =
        random.edge() ? random.one_of({0.0f, 0.01f, 0.0101f, 0.1f, 1.0f}) : random.between(0.3f, 1.0f);
    x.alpha = greater_of(x.roughness * x.roughness, MinAlpha);
    x.index = random.edge() ? random.one_of({0.0f, 1.0f, 1.0001f, 100.0f}) : random.between(1.2f, 2.5f);
    x.eta = random.edge() ? random.one_of({0.0f, 1.0f, 1e-3f, 0.66f}) : random.between(1.2f, 2.5f);
    x.instance =
        random.bits() % (random.edge() ? 8u : 4u);  // the last 4 are edge cases (test_scene_builder.cpp)
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
