#include "mediator/filter/inputs.h"

#include <algorithm>
#include <bit>

#include "mediator/frame/resolve.h"

namespace tessera::filter {

namespace {

using frame::Channel;

// The second half is the difference to all samples.
void split_halves(const frame::FilmTile& film, Inputs& inputs) {
    const std::uint32_t first = film.channels.first_plane(Channel::FirstHalf);
    const std::uint32_t all = film.channels.first_plane(Channel::Radiance);
    for (int half = 0; half < 2; ++half) {
        inputs.halves[half].resize(inputs.width, inputs.height, 3);
        inputs.half_counts[half].resize(inputs.width, inputs.height, 1);
    }
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
        const float n = static_cast<float>(film.counts[i]);
        const float n_first = film.plane(first + 3)[i], n_second = n - n_first;
        inputs.half_counts[0].plane(0)[i] = n_first;
        inputs.half_counts[1].plane(0)[i] = n_second;
        for (std::uint32_t c = 0; c < 3; ++c) {
            const float mean = film.plane(all + c)[i], mean_first = film.plane(first + c)[i];
            const bool has_both = n_first > 0.0f && n_second > 0.0f;
            inputs.halves[0].plane(c)[i] = has_both ? mean_first : mean;
            inputs.halves[1].plane(c)[i] =
                has_both ? mean + (mean - mean_first) * (n_first / n_second) : mean;
        }
    }
}

void clear_channel(const frame::ChannelInfo& entry, Inputs& inputs) {
    const auto index = static_cast<std::size_t>(entry.channel);
    inputs.means[index].resize(0, 0, 0);
    inputs.variances[index].resize(0, 0, 0);
    if (entry.channel == Channel::ObjectIndex) inputs.object_ids.clear();
    if (entry.channel == Channel::FirstHalf) {
        for (Planes& half : inputs.halves) half.resize(0, 0, 0);
        for (Planes& counts : inputs.half_counts) counts.resize(0, 0, 0);
    }
}

void take_channel(const frame::FilmTile& film, const frame::ChannelInfo& entry,
                  std::span<const float> design_effect, Inputs& inputs) {
    const auto index = static_cast<std::size_t>(entry.channel);
    if (entry.channel == Channel::ObjectIndex) {
        const std::span<const float> ids = film.plane(film.channels.first_plane(entry.channel) + 1);
        inputs.object_ids.resize(ids.size());
        for (std::size_t i = 0; i < ids.size(); ++i)
            inputs.object_ids[i] = std::bit_cast<std::uint32_t>(ids[i]);
    } else if (entry.channel == Channel::FirstHalf) {
        if (film.channels.contains(Channel::Radiance)) {
            split_halves(film, inputs);
        } else {
            clear_channel(entry, inputs);
        }
    } else {
        Planes& means = inputs.means[index];
        Planes& variances = inputs.variances[index];
        means.resize(inputs.width, inputs.height, entry.components);
        const bool has_moments = entry.rule == frame::MergeRule::Moments;
        if (has_moments) variances.resize(inputs.width, inputs.height, entry.components);
        for (std::uint32_t c = 0; c < entry.components; ++c) {
            frame::resolve(film, entry.channel, c, means.plane(c));
            if (!has_moments) continue;
            const std::span<float> variance = variances.plane(c);
            frame::resolve_variance_of_mean(film, entry.channel, c, variance);
            for (std::size_t i = 0; i < variance.size(); ++i) variance[i] *= design_effect[i];
        }
    }
}

}  // namespace

void resolve_inputs(const frame::FilmTile& film, const view::View& view, const frame::FilmTile* later,
                    Inputs& inputs) {
    inputs.width = static_cast<std::uint32_t>(film.rect.width);
    inputs.height = static_cast<std::uint32_t>(film.rect.height);
    inputs.camera = view.camera;
    inputs.path_class = view.path_class;
    inputs.changes = {};
    inputs.counts.resize(inputs.width, inputs.height, 1);
    frame::resolve_counts(film, inputs.counts.plane(0));
    // That of fewer samples is larger, not smaller.
    const bool is_known = later == nullptr || film.channels.contains(Channel::BlockVariance);
    const std::span<const float> effect = inputs.design_effect.measure(is_known ? film : *later);
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        if (film.channels.contains(entry.channel)) {
            take_channel(film, entry, effect, inputs);
        } else if (later != nullptr && later->channels.contains(entry.channel)) {
            take_channel(*later, entry, effect, inputs);
        } else {
            clear_channel(entry, inputs);
        }
    }
}

Inputs make_inputs(const frame::FilmTile& film, const view::View& view, const frame::FilmTile* later) {
    Inputs inputs;
    resolve_inputs(film, view, later, inputs);
    return inputs;
}

}  // namespace tessera::filter
