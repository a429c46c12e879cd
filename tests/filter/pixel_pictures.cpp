#include "tests/filter/pixel_pictures.h"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "mediator/base/random.h"

namespace tessera::filter {

using frame::Channel;

Inputs pixel_inputs(std::uint32_t width, std::uint32_t height,
                    const std::function<PixelLight(std::uint32_t, std::uint32_t)>& light) {
    Inputs inputs;
    inputs.width = width;
    inputs.height = height;
    inputs.counts = Planes(width, height, 1);
    const auto mean = [&](Channel channel) -> Planes& {
        return inputs.means[static_cast<std::size_t>(channel)];
    };
    const auto variance = [&](Channel channel) -> Planes& {
        return inputs.variances[static_cast<std::size_t>(channel)];
    };
    for (const Channel channel : {Channel::Radiance, Channel::LowVariance, Channel::HighVariance,
                                  Channel::Headlight, Channel::Normal}) {
        mean(channel) = Planes(width, height, 3);
    }
    for (const Channel channel : {Channel::Radiance, Channel::LowVariance, Channel::HighVariance}) {
        variance(channel) = Planes(width, height, 3);
    }
    mean(Channel::Depth) = Planes(width, height, 1);
    mean(Channel::Alpha) = Planes(width, height, 1);
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const PixelLight p = light(x, y);
            inputs.counts.row(0, y)[x] = p.n;
            mean(Channel::Depth).row(0, y)[x] = p.depth;
            mean(Channel::Alpha).row(0, y)[x] = p.alpha;
            mean(Channel::Normal).row(2, y)[x] = p.normal_z;
            mean(Channel::Normal).row(0, y)[x] = std::sqrt(std::max(0.0f, 1.0f - p.normal_z * p.normal_z));
            for (std::uint32_t c = 0; c < 3; ++c) {
                mean(Channel::Radiance).row(c, y)[x] = p.low + p.high;
                mean(Channel::LowVariance).row(c, y)[x] = p.low;
                mean(Channel::HighVariance).row(c, y)[x] = p.high;
                mean(Channel::Headlight).row(c, y)[x] = p.headlight;
                variance(Channel::Radiance).row(c, y)[x] = p.variance;
                variance(Channel::HighVariance).row(c, y)[x] = p.variance;
            }
        }
    }
    return inputs;
}

const Planes& map_of(const Output& out, const std::string& name) {
    const auto found = std::ranges::find_if(out.maps, [&](const DebugMap& map) { return map.name == name; });
    if (found == out.maps.end()) throw std::out_of_range("no map " + name);
    return found->planes;
}

float noise(std::uint64_t seed, std::uint32_t x, std::uint32_t y) {
    return static_cast<float>(CounterRandom(seed, std::uint64_t{y} << 32 | x).uniform());
}

double relative_error(const Planes& a, const Planes& b) {
    double sum = 0.0;
    for (std::uint32_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < b.pixel_count(); ++i) {
            const double difference = double(a.plane(c)[i]) - double(b.plane(c)[i]);
            sum += difference * difference / (double(b.plane(c)[i]) * b.plane(c)[i] + 0.01);
        }
    }
    return sum / static_cast<double>(3 * b.pixel_count());
}

}  // namespace tessera::filter
