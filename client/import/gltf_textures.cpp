#include "client/import/gltf_textures.h"

#include <tiny_gltf.h>

#include "client/import/gltf_accessor.h"
#include "client/import/image_decoder.h"

namespace tessera::import {
namespace {

template <class T>
const T* find(const std::vector<T>& values, int index) {
    const bool there = index >= 0 && static_cast<std::size_t>(index) < values.size();
    return there ? &values[static_cast<std::size_t>(index)] : nullptr;
}

scene::Wrap wrap(int mode) {
    switch (mode) {
        case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
            return scene::Wrap::Clamp;
        case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
            return scene::Wrap::Mirror;
        default:
            return scene::Wrap::Repeat;
    }
}

std::string image_name(const tinygltf::Image& image, int index) {
    if (!image.name.empty()) return image.name;
    if (!image.uri.empty() && !image.uri.starts_with("data:")) return image.uri.substr(0, 200);
    return "image " + std::to_string(index);
}

}  // namespace

const std::optional<GltfTextures::Texels>& GltfTextures::decoded(int index) {
    const auto [place, is_new] = images_.try_emplace(index);
    if (!is_new) return place->second;
    const tinygltf::Image* image = find(model_.images, index);
    if (!image) {
        builder_.notice("image " + std::to_string(index) + " is missing: export the scene again");
        return place->second;
    }
    std::string cause;
    try {
        const bool embedded = image->bufferView >= 0;
        const std::span<const unsigned char> bytes = embedded ? GltfAccessors(model_).view(image->bufferView)
                                                              : std::span<const unsigned char>(image->image);
        if (bytes.empty() && !image->uri.empty()) {
            cause = "its file cannot be read";
        } else if (const Expected<DecodedImage> pixels = decode_image(bytes)) {
            place->second = Texels{pixels->width, pixels->height, builder_.blob(pixels->rgba)};
        } else {
            cause = pixels.error().what();
        }
    } catch (const Error& error) {
        if (error.code() == ErrorCode::OutOfMemory) throw;
        cause = error.what();
    }
    if (!cause.empty()) {
        builder_.notice("texture '" + image_name(*image, index) + "' cannot be used (" + cause +
                        "): a magenta checker or the plain factor stands for it");
    }
    return place->second;
}

ObjectId GltfTextures::texture(int index, TextureUse use) {
    const tinygltf::Texture* source = find(model_.textures, index);
    const std::optional<Texels>& texels = decoded(source ? source->source : -1);
    if (!texels) return use == TextureUse::Color ? builder_.placeholder_texture() : ObjectId{};

    scene::Texture texture;
    texture.width = texels->width;
    texture.height = texels->height;
    texture.format = use == TextureUse::Color ? scene::TexelFormat::Rgba8Srgb : scene::TexelFormat::Rgba8;
    texture.texels = texels->blob;
    if (const tinygltf::Sampler* sampler = find(model_.samplers, source->sampler)) {
        texture.wrap_s = wrap(sampler->wrapS);
        texture.wrap_t = wrap(sampler->wrapT);
        if (sampler->magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST)
            texture.filter = scene::TextureFilter::Nearest;
    }
    const tinygltf::Image& image = model_.images[static_cast<std::size_t>(source->source)];
    texture.name = source->name.empty() ? image_name(image, source->source) : source->name;
    ObjectId& made = made_[{source->source, texture.format, texture.wrap_s, texture.wrap_t, texture.filter}];
    if (!made) {
        made = builder_.add(std::move(texture));
        ++builder_.result().counts.textures;
    }
    return made;
}

}  // namespace tessera::import
