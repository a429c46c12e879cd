#include "tests/bench/filters/film_groups.h"

#include <algorithm>

namespace tessera::tools::bench {

std::vector<FilmGroup> film_groups(const std::vector<filter::Choice>& filters) {
    std::vector<FilmGroup> groups;
    for (std::size_t i = 0; i < filters.size(); ++i) {
        const frame::ChannelSet channels = filter::wanted_channels(filters[i], {});
        const view::PathClass path_class = filters[i].entry->description.path_class;
        auto group = std::find_if(groups.begin(), groups.end(),
                                  [&](const FilmGroup& g) { return g.path_class == path_class; });
        if (group == groups.end()) group = groups.insert(group, {.path_class = path_class});
        group->channels = group->channels | channels;
        group->filters.push_back(i);
    }
    return groups;
}

double SamplingCost::of(frame::ChannelSet channels, view::PathClass path_class, const std::stop_token& stop) {
    constexpr int Tries = 3;
    constexpr std::uint64_t Spp = 4;
    const auto key = std::pair(channels.words(), path_class);
    if (const auto found = known_.find(key); found != known_.end()) return found->second;
    const view::View view = sampler_.view(size_.width, size_.height, channels, path_class, 0);
    double best = 0.0;
    for (int i = 0; i < Tries; ++i) {
        GrowingFilm film = sampler_.film(view);
        if (!sampler_.grow(film, Spp, stop)) return 0.0;
        if (i == 0 || film.seconds() < best) best = film.seconds();
    }
    return known_[key] = best / (double(Spp) * double(size_.width) * double(size_.height));
}

}  // namespace tessera::tools::bench
