#pragma once

#include <compare>
#include <cstdint>
#include <map>

#include "mediator/scene/blob.h"
#include "mediator/scene/objects.h"

namespace tessera::backend {

// How many levels a texture has below its own: to 1 x 1.
std::uint32_t level_count(std::uint32_t width, std::uint32_t height);

// All levels of a texture but its own, as shading::Texture wants them: each texel is the mean, over its area,
// of the texture's own texels; of sRGB ones the mean of their linear values. At most a third of the texture.
// For formats of 8 bits.
scene::BlobPtr make_levels(const scene::Texture& texture, const scene::Blob& texels);

// Levels of the textures of one scene: made once for each content, and kept as long as a scene uses them.
class TexturePyramids {
  public:
    // Null for a texture that has none: a single texel, floats, or one that is to be seen texel by texel.
    scene::BlobPtr levels(const scene::Texture& texture, const scene::Blob& texels);
    void drop_unused();  // what was not asked for since the last call

  private:
    struct Key {
        Hash256 hash;
        std::uint32_t width = 0, height = 0;
        scene::TexelFormat format = scene::TexelFormat::Rgba8;
        friend auto operator<=>(const Key&, const Key&) = default;
    };
    struct Made {
        scene::BlobPtr levels;
        bool used = false;
    };
    std::map<Key, Made> made_;
};

}  // namespace tessera::backend
