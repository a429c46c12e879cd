#include "mediator/backend/tables/mipmap_cache.h"

#include <algorithm>
#include <bit>
#include <glm/vec4.hpp>
#include <vector>

#include "mediator/backend/tables/tables.h"

namespace tessera::backend {

namespace {

// Linear float values, so that each level is rounded only once.
struct MipLevel {
    std::uint32_t width = 0, height = 0;
    std::vector<glm::vec4> texels;
};

MipLevel decoded(const scene::Texture& texture, const scene::Blob& texels) {
    const auto srgb = srgb_values();
    const bool is_srgb = texture.format == scene::TexelFormat::Rgba8Srgb;
    const auto bytes = texels.as<std::uint8_t>();
    MipLevel level{texture.width, texture.height, {}};
    level.texels.reserve(std::size_t{level.width} * level.height);
    for (std::size_t i = 0; i < std::size_t{level.width} * level.height; ++i) {
        const auto value = [&](std::size_t k) {
            const std::uint8_t byte = bytes[4 * i + k];
            return is_srgb && k < 3 ? srgb[byte] : static_cast<float>(byte) / 255.0f;
        };
        level.texels.emplace_back(value(0), value(1), value(2), value(3));
    }
    return level;
}

std::uint8_t encoded(float value, std::span<const float> values) {
    // The nearest value of the ascending table.
    const auto above = std::lower_bound(values.begin(), values.end(), value);
    if (above == values.end()) return 255;
    const auto index = static_cast<std::size_t>(above - values.begin());
    const bool lower_is_nearer = index > 0 && value - values[index - 1] < *above - value;
    return static_cast<std::uint8_t>(lower_is_nearer ? index - 1 : index);
}

// Half the size along one axis, rounded down: each texel covers two texels, or a little more.
template <class At>
std::vector<glm::vec4> halved(std::uint32_t old_size, std::uint32_t lines, const At& at) {
    const std::uint32_t size = std::max(old_size / 2, 1u);
    const double step = static_cast<double>(old_size) / static_cast<double>(size);
    std::vector<glm::vec4> texels(std::size_t{size} * lines);
    for (std::uint32_t i = 0; i < size; ++i) {
        const double from = i * step, to = (i + 1) * step;
        const auto first = static_cast<std::uint32_t>(from);
        for (std::uint32_t k = first; k < old_size && k < to; ++k) {
            const double covered = std::min(to, k + 1.0) - std::max(from, double(k));
            const auto weight = static_cast<float>(covered / step);
            for (std::uint32_t line = 0; line < lines; ++line)
                texels[std::size_t{line} * size + i] += weight * at(k, line);
        }
    }
    return texels;
}

MipLevel downsampled(const MipLevel& level) {
    const auto across = halved(level.width, level.height, [&](std::uint32_t x, std::uint32_t y) {
        return level.texels[std::size_t{y} * level.width + x];
    });
    const std::uint32_t width = std::max(level.width / 2, 1u), height = std::max(level.height / 2, 1u);
    const auto columns = halved(level.height, width, [&](std::uint32_t y, std::uint32_t x) {
        return across[std::size_t{y} * width + x];
    });
    MipLevel result{width, height, std::vector<glm::vec4>(columns.size())};
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x)
            result.texels[std::size_t{y} * width + x] = columns[std::size_t{x} * height + y];
    }
    return result;
}

}  // namespace

std::uint32_t level_count(std::uint32_t width, std::uint32_t height) {
    return static_cast<std::uint32_t>(std::bit_width(std::max(width, height))) - 1;
}

scene::BlobPtr make_mipmaps(const scene::Texture& texture, const scene::Blob& texels) {
    std::vector<float> plain(256);
    for (std::size_t i = 0; i < plain.size(); ++i) plain[i] = static_cast<float>(i) / 255.0f;
    const auto colors =
        texture.format == scene::TexelFormat::Rgba8Srgb ? srgb_values() : std::span<const float>(plain);
    std::vector<std::uint8_t> bytes;
    MipLevel level = decoded(texture, texels);
    while (level.width > 1 || level.height > 1) {
        level = downsampled(level);
        for (const glm::vec4& texel : level.texels) {
            for (int k = 0; k < 4; ++k) bytes.push_back(encoded(texel[k], k < 3 ? colors : plain));
        }
    }
    return std::make_shared<const scene::Blob>(std::as_bytes(std::span(bytes)));
}

scene::BlobPtr MipmapCache::levels(const scene::Texture& texture, const scene::Blob& texels) {
    if (texture.format == scene::TexelFormat::RgbFloat || texture.filter == scene::TextureFilter::Nearest ||
        level_count(texture.width, texture.height) == 0)
        return nullptr;
    Entry& entry = entries_[{texels.hash(), texture.width, texture.height, texture.format}];
    if (!entry.levels) entry.levels = make_mipmaps(texture, texels);
    entry.used = true;
    return entry.levels;
}

void MipmapCache::drop_unused() {
    std::erase_if(entries_, [](const auto& entry) { return !entry.second.used; });
    for (auto& [key, entry] : entries_) entry.used = false;
}

}  // namespace tessera::backend
