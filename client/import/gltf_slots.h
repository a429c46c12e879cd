#pragma once

#include <tiny_gltf.h>

#include <algorithm>
#include <string>

#include "client/import/gltf_document.h"
#include "client/import/gltf_textures.h"

namespace tessera::import {

inline const tinygltf::Value* gltf_extension(const tinygltf::ExtensionMap& extensions, const char* name) {
    const auto found = extensions.find(name);
    return found == extensions.end() ? nullptr : &found->second;
}

// Reads the texture references of one material.
class GltfSlots {
  public:
    GltfSlots(GltfTextures& textures, const std::string& material)
        : textures_(textures), material_(material) {}

    template <class Info>
    scene::TextureSlot slot(const Info& info, TextureUse use) {
        return slot(info.index, info.texCoord, gltf_extension(info.extensions, "KHR_texture_transform"), use);
    }

    // The texture that a member of an extension refers to.
    scene::TextureSlot slot(const tinygltf::Value& owner, const char* member, TextureUse use) {
        if (!owner.Has(member)) return {};
        const tinygltf::Value& info = owner.Get(member);
        if (!info.IsObject() || !info.Has("index")) return {};
        const tinygltf::Value* transform = nullptr;
        if (info.Has("extensions") && info.Get("extensions").Has("KHR_texture_transform")) {
            transform = &info.Get("extensions").Get("KHR_texture_transform");
        }
        const int set = info.Has("texCoord") ? index_member(info, "texCoord") : 0;
        return slot(index_member(info, "index"), set, transform, use);
    }

    auto reader() {
        return [this](const tinygltf::Value& owner, const char* member, TextureUse use) {
            return slot(owner, member, use);
        };
    }

    // Only two sets of texture coordinates are supported: the second is used for any further ones.
    bool has_unsupported_set() const { return has_unsupported_set_; }

  private:
    scene::TextureSlot slot(int index, int set, const tinygltf::Value* transform, TextureUse use) {
        scene::TextureSlot slot;
        if (index < 0) return slot;
        slot.texture = textures_.texture(index, use, material_);
        if (transform != nullptr && transform->IsObject()) {
            const std::vector<double> offset = number_array(*transform, "offset");
            const std::vector<double> scale = number_array(*transform, "scale");
            for (int i = 0; i < 2; ++i) {
                const auto k = static_cast<std::size_t>(i);
                if (offset.size() == 2) slot.offset[i] = static_cast<float>(offset[k]);
                if (scale.size() == 2) slot.scale[i] = static_cast<float>(scale[k]);
            }
            slot.rotation = static_cast<float>(number_member(*transform, "rotation", 0.0));
            if (transform->Has("texCoord")) set = index_member(*transform, "texCoord");
        }
        if (!slot.texture) return slot;
        has_unsupported_set_ |= set > 1;
        slot.set = static_cast<std::uint32_t>(std::clamp(set, 0, 1));
        return slot;
    }

    GltfTextures& textures_;
    const std::string& material_;
    bool has_unsupported_set_ = false;
};

}  // namespace tessera::import
