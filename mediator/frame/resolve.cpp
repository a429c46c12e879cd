#include "mediator/frame/resolve.h"

#include <cmath>
#include <cstring>

namespace tessera::frame {

namespace {

Image blank(const FilmTile& film, std::uint32_t components) {
    return Image(static_cast<std::uint32_t>(film.rect.width), static_cast<std::uint32_t>(film.rect.height),
                 components);
}

// Every `stride`-th value from `first` on.
struct Target {
    float* first;
    std::size_t stride;

    // Copies bits: object ids are not floats.
    void copy(std::size_t i, const float& value) const {
        std::memcpy(first + i * stride, &value, sizeof value);
    }
};

void write_values(const FilmTile& film, Channel channel, std::uint32_t component, Target to) {
    const std::span<const float> plane = film.plane(film.channels.first_plane(channel) + component);
    if (info(channel).rule == MergeRule::Sum) {
        for (std::size_t i = 0; i < plane.size(); ++i) {
            to.first[i * to.stride] =
                film.counts[i] == 0 ? 0.0f : plane[i] / static_cast<float>(film.counts[i]);
        }
    } else {
        for (std::size_t i = 0; i < plane.size(); ++i) to.copy(i, plane[i]);
    }
}

// For channels with moments.
void write_variances(const FilmTile& film, Channel channel, std::uint32_t component, Target to) {
    const std::uint32_t first = film.channels.first_plane(channel) + info(channel).components;
    const std::span<const float> m2 = film.plane(first + component);
    for (std::size_t i = 0; i < m2.size(); ++i) {
        const float n = static_cast<float>(film.counts[i]);
        to.first[i * to.stride] = film.counts[i] < 2 ? 0.0f : m2[i] / (n - 1.0f) / n;
    }
}

}  // namespace

void resolve(const FilmTile& film, Channel channel, std::uint32_t component, std::span<float> plane) {
    write_values(film, channel, component, {plane.data(), 1});
}

void resolve_variance_of_mean(const FilmTile& film, Channel channel, std::uint32_t component,
                              std::span<float> plane) {
    write_variances(film, channel, component, {plane.data(), 1});
}

void resolve_counts(const FilmTile& film, std::span<float> plane) {
    for (std::size_t i = 0; i < film.counts.size(); ++i) plane[i] = static_cast<float>(film.counts[i]);
}

Image resolve(const FilmTile& film, Channel channel) {
    const std::uint32_t components = info(channel).components;
    Image image = blank(film, components);
    for (std::uint32_t c = 0; c < components; ++c)
        write_values(film, channel, c, {image.values.data() + c, components});
    return image;
}

Image resolve_picture(const FilmTile& film) {
    return resolve(film, film.channels.contains(Channel::Radiance) ? Channel::Radiance : Channel::Color);
}

Image resolve_variance_of_mean(const FilmTile& film, Channel channel) {
    const std::uint32_t components = info(channel).components;
    Image image = blank(film, components);
    if (info(channel).rule != MergeRule::Moments) return image;
    for (std::uint32_t c = 0; c < components; ++c)
        write_variances(film, channel, c, {image.values.data() + c, components});
    return image;
}

Image resolve_counts(const FilmTile& film) {
    Image image = blank(film, 1);
    resolve_counts(film, image.values);
    return image;
}

Hash256 film_hash(const FilmTile& film) {
    Blake2b hash;
    const auto add = [&](const auto& values) { hash.update(std::as_bytes(std::span(values))); };
    add(std::array{film.rect.width, film.rect.height});
    // Films without channels from 32 on keep the hashes of older versions.
    const ChannelSet::Words& words = film.channels.words();
    add(std::array{static_cast<std::uint32_t>(words[0])});
    if (words[0] >> 32 != 0 || words[1] != 0) add(words);
    add(film.counts);
    for (const ChannelInfo& entry : channel_table()) {
        if (!film.channels.contains(entry.channel)) continue;
        const std::uint32_t first = film.channels.first_plane(entry.channel);
        for (std::uint32_t plane = 0; plane < entry.plane_count(); ++plane) add(film.plane(first + plane));
    }
    return hash.finish();
}

}  // namespace tessera::frame
