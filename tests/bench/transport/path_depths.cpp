#include "tests/bench/transport/path_depths.h"

#include <algorithm>
#include <array>

#include "mediator/frame/resolve.h"
#include "tests/bench/filters/looks.h"

namespace tessera::tools::bench {

double relative_noise(const frame::Image& first, const frame::Image& second, const ReferencePair& truth) {
    double sum = 0.0;
    for (std::size_t i = 0; i < first.values.size(); ++i) {
        const double difference = double(first.values[i]) - double(second.values[i]),
                     mean = truth.mean().values[i];
        sum += 0.5 * difference * difference / (mean * mean + truth.epsilon());
    }
    return sum / double(first.values.size());
}

std::optional<std::vector<PathDepth>> measure_depths(const Sampler& sampler, const view::View& view,
                                                     const ReferencePair& truth, std::uint64_t spp,
                                                     const std::stop_token& stop) {
    std::vector<std::uint32_t> limits;
    for (std::uint32_t limit = 0; limit < std::min(3u, view.max_bounces); ++limit) limits.push_back(limit);
    limits.push_back(view.max_bounces);
    std::vector<PathDepth> depths;
    for (const std::uint32_t limit : limits) {
        PathDepth depth{.bounces = limit};
        std::array<frame::Image, 2> pictures;
        for (std::uint64_t i = 0; i < pictures.size(); ++i) {
            view::View shorter = view;
            shorter.max_bounces = limit;
            shorter.seed = view.seed + i;
            GrowingFilm film = sampler.film(shorter);
            if (!sampler.grow(film, spp, stop)) return std::nullopt;
            pictures[i] = frame::resolve(film.whole(), frame::Channel::Radiance);
            depth.seconds += film.seconds() / pictures.size();
            depth.light += mean_luminance(pictures[i]) / mean_luminance(truth.mean()) / pictures.size();
        }
        depth.noise = relative_noise(pictures[0], pictures[1], truth);
        depths.push_back(depth);
    }
    return depths;
}

}  // namespace tessera::tools::bench
