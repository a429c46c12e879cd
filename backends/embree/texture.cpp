#include "backends/embree/texture.h"

#include <array>
#include <cmath>

namespace tessera::embree {

namespace {

// IEC 61966-2-1, once per value a byte can have.
std::array<float, 256> make_srgb_table() {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
        const double c = static_cast<double>(i) / 255.0;
        table[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return table;
}

const std::array<float, 256> SrgbTable = make_srgb_table();

// Any integer coordinate to a texel. Coordinates come from floats, so they are clamped first.
std::uint32_t wrapped(std::int64_t i, std::uint32_t size, scene::Wrap wrap) {
    const std::int64_t n = size;
    switch (wrap) {
        case scene::Wrap::Clamp:
            return static_cast<std::uint32_t>(std::min(std::max<std::int64_t>(i, 0), n - 1));
        case scene::Wrap::Repeat:
            return static_cast<std::uint32_t>(((i % n) + n) % n);
        case scene::Wrap::Mirror: {
            const std::int64_t j = ((i % (2 * n)) + 2 * n) % (2 * n);
            return static_cast<std::uint32_t>(j < n ? j : 2 * n - 1 - j);
        }
    }
    return 0;
}

glm::vec4 texel(const TextureData& texture, std::int64_t x, std::int64_t y) {
    const std::size_t index = std::size_t{wrapped(y, texture.height, texture.wrap_t)} * texture.width +
                              wrapped(x, texture.width, texture.wrap_s);
    if (texture.format == scene::TexelFormat::RgbFloat) {
        const float* rgb = texture.texels->as<float>().data() + 3 * index;
        return {rgb[0], rgb[1], rgb[2], 1.0f};
    }
    const std::uint8_t* rgba = texture.texels->as<std::uint8_t>().data() + 4 * index;
    constexpr float Unit = 1.0f / 255.0f;
    if (texture.format == scene::TexelFormat::Rgba8Srgb) {
        return {SrgbTable[rgba[0]], SrgbTable[rgba[1]], SrgbTable[rgba[2]],
                static_cast<float>(rgba[3]) * Unit};
    }
    return glm::vec4(rgba[0], rgba[1], rgba[2], rgba[3]) * Unit;
}

float sane(float coordinate) {
    constexpr float Limit = 1e9f;  // beyond, a float has no fraction left: any texel is as good
    return coordinate > -Limit && coordinate < Limit ? coordinate : 0.0f;
}

}  // namespace

TextureUse make_use(const scene::TextureSlot& slot, int texture) {
    const float c = std::cos(slot.rotation), s = std::sin(slot.rotation);
    // KHR_texture_transform: uv' = offset + rotation x scale x uv, with v down.
    return {
        texture, {c * slot.scale.x, s * slot.scale.y}, {-s * slot.scale.x, c * slot.scale.y}, slot.offset};
}

glm::vec4 lookup(const TextureData& texture, const glm::vec2& uv) {
    const float x = sane(uv.x * static_cast<float>(texture.width));
    const float y = sane(uv.y * static_cast<float>(texture.height));
    if (texture.filter == scene::TextureFilter::Nearest) {
        return texel(texture, static_cast<std::int64_t>(std::floor(x)),
                     static_cast<std::int64_t>(std::floor(y)));
    }
    const float fx = std::floor(x - 0.5f), fy = std::floor(y - 0.5f);
    const float wx = x - 0.5f - fx, wy = y - 0.5f - fy;
    const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy);
    const glm::vec4 top = texel(texture, ix, iy) * (1.0f - wx) + texel(texture, ix + 1, iy) * wx;
    const glm::vec4 bottom = texel(texture, ix, iy + 1) * (1.0f - wx) + texel(texture, ix + 1, iy + 1) * wx;
    return top * (1.0f - wy) + bottom * wy;
}

glm::vec4 lookup(const std::vector<TextureData>& textures, const TextureUse& use, const glm::vec2& uv) {
    if (use.texture < 0) return glm::vec4(1.0f);
    return lookup(textures[static_cast<std::size_t>(use.texture)],
                  {use.row_u.x * uv.x + use.row_u.y * uv.y + use.offset.x,
                   use.row_v.x * uv.x + use.row_v.y * uv.y + use.offset.y});
}

}  // namespace tessera::embree
