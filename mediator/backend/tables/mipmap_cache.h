#pragma once

#include <compare>
#include <cstdint>
#include <map>

#include "mediator/scene/blob.h"
#include "mediator/scene/objects.h"

namespace tessera::backend {

// The number of mip levels below the full size, down to 1 x 1.
std::uint32_t level_count(std::uint32_t width, std::uint32_t height);

// The mip levels of an 8-bit texture below the full size, in the layout of shading::Texture: each texel is the mean of
// the texels it covers, for sRGB of their linear values. At most a third of the texture's bytes.
scene::BlobPtr make_mipmaps(const scene::Texture& texture, const scene::Blob& texels);

// The mip maps of the textures of one scene: computed once per content, and kept as long as the scene uses them.
class MipmapCache {
  public:
    // Null for a texture without mip levels: a single texel, float texels, or nearest filtering.
    scene::BlobPtr levels(const scene::Texture& texture, const scene::Blob& texels);
    void drop_unused();  // entries without a use since the last call

  private:
    struct Key {
        Hash256 hash;
        std::uint32_t width = 0, height = 0;
        scene::TexelFormat format = scene::TexelFormat::Rgba8;
        friend auto operator<=>(const Key&, const Key&) = default;
    };
    struct Entry {
        scene::BlobPtr levels;
        bool used = false;
    };
    std::map<Key, Entry> entries_;
};

}  // namespace tessera::backend
