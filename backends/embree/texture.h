#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "mediator/scene/scene.h"

namespace tessera::embree {

// A texture ready for lookups: texels stay in their blob.
struct TextureData {
    scene::BlobPtr texels;
    std::uint32_t width = 0, height = 0;
    scene::TexelFormat format = scene::TexelFormat::Rgba8;
    scene::Wrap wrap_s = scene::Wrap::Repeat, wrap_t = scene::Wrap::Repeat;
    scene::TextureFilter filter = scene::TextureFilter::Linear;
};

// A use of a texture, with its transform; texture < 0 = none.
struct TextureUse {
    int texture = -1;
    glm::vec2 row_u{1.0f, 0.0f}, row_v{0.0f, 1.0f}, offset{0.0f};
};

TextureUse make_use(const scene::TextureSlot& slot, int texture);

// Linear values (sRGB decoded before filtering), bilinear or nearest; RgbFloat has alpha 1.
glm::vec4 lookup(const TextureData& texture, const glm::vec2& uv);
glm::vec4 lookup(const std::vector<TextureData>& textures, const TextureUse& use, const glm::vec2& uv);

}  // namespace tessera::embree
