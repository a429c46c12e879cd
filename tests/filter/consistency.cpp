#include "tests/filter/consistency.h"

#include <cmath>

#include "mediator/base/random.h"

namespace tessera::filter {

namespace {

constexpr std::uint32_t ConsistencyWidth = 96, ConsistencyHeight = 54;

float light_texture(std::uint32_t x, std::uint32_t y) {
    return static_cast<float>(0.5 + 0.2 * std::sin(0.9 * x) * std::sin(0.7 * y));
}

double relative_squared_error(const Planes& picture, const Planes& truth) {
    double sum = 0.0;
    for (std::uint32_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < truth.pixel_count(); ++i) {
            const double t = truth.plane(c)[i], d = picture.plane(c)[i] - t;
            sum += d * d / (t * t + 0.01);
        }
    }
    return sum;
}

}  // namespace

double error_ratio(const std::string& choice, ConsistencyScene scene, std::uint64_t n) {
    Planes truth = shadowed_texture_truth(ConsistencyWidth, ConsistencyHeight);
    Sampler sampler = [](auto x, auto y, auto i) {
        return shadowed_texture(ConsistencyWidth, ConsistencyHeight, x, y, i);
    };
    if (scene == ConsistencyScene::LightTexture) {
        for (std::uint32_t y = 0; y < ConsistencyHeight; ++y) {
            for (std::uint32_t x = 0; x < ConsistencyWidth; ++x) {
                for (std::uint32_t c = 0; c < 3; ++c) truth.row(c, y)[x] = light_texture(x, y);
            }
        }
        sampler = [](auto x, auto y, auto i) {
            CounterRandom random(mix(7), mix((std::uint64_t{y} << 32 | x) ^ mix(i)));
            SyntheticSample s;
            s.high.fill(-light_texture(x, y) * static_cast<float>(std::log(1.0 - random.uniform())));
            return s;
        };
    }
    const frame::ChannelSet channels{frame::Channel::Radiance, frame::Channel::Albedo, frame::Channel::Normal,
                                     frame::Channel::Depth, frame::Channel::FirstHalf};
    const Inputs inputs = synthetic_inputs(ConsistencyWidth, ConsistencyHeight, n, sampler, channels);
    return relative_squared_error(run_filter(choice, inputs).picture, truth) /
           relative_squared_error(inputs.mean(frame::Channel::Radiance), truth);
}

}  // namespace tessera::filter
