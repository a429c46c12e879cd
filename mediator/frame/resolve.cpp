#include "mediator/frame/resolve.h"

#include <cmath>
#include <cstring>

namespace tessera::frame {

namespace {

Image blank(const FilmTile& film, std::uint32_t components) {
    return Image(static_cast<std::uint32_t>(film.rect.width), static_cast<std::uint32_t>(film.rect.height),
                 components);
}

}  // namespace

Image resolve(const FilmTile& film, Channel channel) {
    const ChannelInfo& entry = info(channel);
    const std::uint32_t first = film.channels.first_plane(channel);
    Image image = blank(film, entry.components);
    for (std::uint32_t c = 0; c < entry.components; ++c) {
        const std::span<const float> plane = film.plane(first + c);
        for (std::size_t i = 0; i < plane.size(); ++i) {
            float& value = image.pixel(i)[c];
            if (entry.rule == MergeRule::Sum) {
                value = film.counts[i] == 0 ? 0.0f : plane[i] / static_cast<float>(film.counts[i]);
            } else {
                std::memcpy(&value, &plane[i], sizeof value);
            }
        }
    }
    return image;
}

Image resolve_picture(const FilmTile& film) {
    return resolve(film, film.channels.contains(Channel::Radiance) ? Channel::Radiance : Channel::Color);
}

Image resolve_variance_of_mean(const FilmTile& film, Channel channel) {
    const ChannelInfo& entry = info(channel);
    Image image = blank(film, entry.components);
    if (entry.rule != MergeRule::Moments) return image;
    const std::uint32_t first = film.channels.first_plane(channel) + entry.components;
    for (std::uint32_t c = 0; c < entry.components; ++c) {
        const std::span<const float> m2 = film.plane(first + c);
        for (std::size_t i = 0; i < m2.size(); ++i) {
            const float n = static_cast<float>(film.counts[i]);
            image.pixel(i)[c] = film.counts[i] < 2 ? 0.0f : m2[i] / (n - 1.0f) / n;
        }
    }
    return image;
}

Image resolve_counts(const FilmTile& film) {
    Image image = blank(film, 1);
    for (std::size_t i = 0; i < film.counts.size(); ++i) image.values[i] = static_cast<float>(film.counts[i]);
    return image;
}

Hash256 film_hash(const FilmTile& film) {
    Blake2b hash;
    const auto add = [&](const auto& values) { hash.update(std::as_bytes(std::span(values))); };
    add(std::array{film.rect.width, film.rect.height});
    add(std::array{film.channels.bits()});
    add(film.counts);
    for (const ChannelInfo& entry : channel_table()) {
        if (!film.channels.contains(entry.channel)) continue;
        const std::uint32_t first = film.channels.first_plane(entry.channel);
        for (std::uint32_t plane = 0; plane < entry.plane_count(); ++plane) add(film.plane(first + plane));
    }
    return hash.finish();
}

}  // namespace tessera::frame
