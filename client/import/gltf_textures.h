#pragma once

#include <map>
#include <string>
#include <tuple>

#include "client/import/gltf_document.h"
#include "client/import/scene_builder.h"
#include "client/import/texture_use.h"

namespace tessera::import {

// Creates Texture objects on demand: one per image, sampler and colour space. Each image is decoded once; one
// used in both colour spaces becomes two objects that share a blob. Invalid textures give one notice per
// material.
class GltfTextures {
  public:
    GltfTextures(const tinygltf::Model& model, SceneBuilder& builder) : model_(model), builder_(builder) {}

    ObjectId texture(int index, TextureUse use, const std::string& material);  // 0 for invalid data textures

  private:
    struct Texels {
        std::uint32_t width = 0, height = 0;
        scene::BlobRef blob;
        scene::TexelFormat format = scene::TexelFormat::Rgba8;  // RgbFloat: a 16-bit image for data
    };
    const Expected<Texels>& decoded(int image, TextureUse use);
    Expected<Texels> decode(int image, TextureUse use);

    const tinygltf::Model& model_;
    SceneBuilder& builder_;
    std::map<std::pair<int, TextureUse>, Expected<Texels>> images_;
    std::map<
        std::tuple<int, std::uint32_t, scene::TexelFormat, scene::Wrap, scene::Wrap, scene::TextureFilter>,
        ObjectId>
        cached_;
};

}  // namespace tessera::import
