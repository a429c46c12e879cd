#include "tests/bench/consistency/rare_light.h"

#include <algorithm>
#include <array>
#include <vector>

#include "mediator/frame/resolve.h"

namespace tessera::tools::bench {

double rare_light(const frame::FilmTile& film, std::uint64_t spp) {
    constexpr std::array Weights{0.2126, 0.7152, 0.0722};
    constexpr double Finds = 3.0;
    const frame::Image mean = frame::resolve(film, frame::Channel::Radiance),
                       variance = frame::resolve_variance_of_mean(film, frame::Channel::Radiance);
    const auto width = static_cast<std::int32_t>(mean.width), height = static_cast<std::int32_t>(mean.height);
    std::vector<double> light(mean.pixel_count()), square(mean.pixel_count());
    for (std::size_t i = 0; i < light.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double value = mean.values[3 * i + c];
            light[i] += Weights[c] * value;
            square[i] += Weights[c] * (value * value + double(film.counts[i]) * variance.values[3 * i + c]);
        }
    }
    double all = 0.0, rare = 0.0;
    for (std::int32_t y = 0; y < height; ++y) {
        for (std::int32_t x = 0; x < width; ++x) {
            double light_around = 0.0, square_around = 0.0;
            for (std::int32_t v = std::max(0, y - 2); v <= std::min(height - 1, y + 2); ++v) {
                for (std::int32_t u = std::max(0, x - 2); u <= std::min(width - 1, x + 2); ++u) {
                    light_around += light[static_cast<std::size_t>(v) * width + u];
                    square_around += square[static_cast<std::size_t>(v) * width + u];
                }
            }
            const double here = light[static_cast<std::size_t>(y) * width + x];
            all += here;
            if (double(spp) * light_around * light_around < Finds * square_around) rare += here;
        }
    }
    return all > 0.0 ? rare / all : 0.0;
}

}  // namespace tessera::tools::bench
