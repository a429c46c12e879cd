#include "mediator/filter/inputs.h"

#include <algorithm>
#include <bit>

#include "mediator/frame/resolve.h"

namespace tessera::filter {

namespace {

using frame::Channel;

// The even samples are stored as sum and count; the odd ones are the difference to all samples.
void split_halves(const frame::FilmTile& film, Inputs& inputs) {
    const std::uint32_t even = film.channels.first_plane(Channel::HalfBufferA);
    const std::uint32_t all = film.channels.first_plane(Channel::Radiance);
    for (int half = 0; half < 2; ++half) {
        inputs.halves[half].resize(inputs.width, inputs.height, 3);
        inputs.half_counts[half].resize(inputs.width, inputs.height, 1);
    }
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
        const float n = static_cast<float>(film.counts[i]);
        const float n_even = film.plane(even + 3)[i], n_odd = n - n_even;
        inputs.half_counts[0].plane(0)[i] = n_even;
        inputs.half_counts[1].plane(0)[i] = n_odd;
        for (std::uint32_t c = 0; c < 3; ++c) {
            const float mean = film.plane(all + c)[i], sum = film.plane(even + c)[i];
            inputs.halves[0].plane(c)[i] = n_even > 0.0f ? sum / n_even : mean;
            inputs.halves[1].plane(c)[i] = n_odd > 0.0f ? (n * mean - sum) / n_odd : mean;
        }
    }
}

void clear_channel(const frame::ChannelInfo& entry, Inputs& inputs) {
    const auto index = static_cast<std::size_t>(entry.channel);
    inputs.means[index].resize(0, 0, 0);
    inputs.variances[index].resize(0, 0, 0);
    if (entry.channel == Channel::ObjectIndex) inputs.object_ids.clear();
    if (entry.channel == Channel::HalfBufferA) {
        for (Planes& half : inputs.halves) half.resize(0, 0, 0);
        for (Planes& counts : inputs.half_counts) counts.resize(0, 0, 0);
    }
}

void take_channel(const frame::FilmTile& film, const frame::ChannelInfo& entry, Inputs& inputs) {
    const auto index = static_cast<std::size_t>(entry.channel);
    if (entry.channel == Channel::ObjectIndex) {
        const std::span<const float> ids = film.plane(film.channels.first_plane(entry.channel) + 1);
        inputs.object_ids.resize(ids.size());
        for (std::size_t i = 0; i < ids.size(); ++i)
            inputs.object_ids[i] = std::bit_cast<std::uint32_t>(ids[i]);
    } else if (entry.channel == Channel::HalfBufferA) {
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
            if (has_moments) frame::resolve_variance_of_mean(film, entry.channel, c, variances.plane(c));
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
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        if (film.channels.contains(entry.channel)) {
            take_channel(film, entry, inputs);
        } else if (later != nullptr && later->channels.contains(entry.channel)) {
            take_channel(*later, entry, inputs);
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
