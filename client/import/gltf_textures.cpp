#include "client/import/gltf_textures.h"

#include <tiny_gltf.h>

#include "client/import/gltf_accessor.h"
#include "client/import/gltf_extras.h"
#include "client/import/image_decoder.h"
#include "client/import/limits.h"

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

// Colours have eight bits in sRGB, whose steps are not seen. Steps of normals are, in mirrors.
Expected<GltfTextures::Texels> GltfTextures::decode(int index, TextureUse use) {
    const tinygltf::Image* image = find(model_.images, index);
    if (!image) return failure(ErrorCode::InvalidInput, "the file has no image " + std::to_string(index));
    try {
        const bool embedded = image->bufferView >= 0;
        const std::span<const unsigned char> bytes = embedded ? GltfAccessors(model_).view(image->bufferView)
                                                              : std::span<const unsigned char>(image->image);
        if (bytes.empty() && !image->uri.empty())
            return failure(ErrorCode::InvalidInput,
                           "its file cannot be read: put it into the scene's folder");
        if (use == TextureUse::Data) {
            const auto deep = picture::read_png16(std::as_bytes(bytes), ImageLimits);
            if (!deep) return tl::unexpected<Error>(deep.error());
            if (*deep)
                return Texels{(*deep)->width, (*deep)->height, builder_.blob((*deep)->values),
                              scene::TexelFormat::RgbFloat};
        }
        const Expected<DecodedImage> pixels = decode_image(bytes);
        if (!pixels) return tl::unexpected<Error>(pixels.error());
        return Texels{pixels->width, pixels->height, builder_.blob(pixels->rgba), scene::TexelFormat::Rgba8};
    } catch (const Error& error) {
        if (error.code() == ErrorCode::OutOfMemory) throw;
        return tl::unexpected<Error>(error);
    }
}

const Expected<GltfTextures::Texels>& GltfTextures::decoded(int index, TextureUse use) {
    const std::pair key(index, use);
    const auto found = images_.find(key);
    return found != images_.end() ? found->second : images_.emplace(key, decode(index, use)).first->second;
}

ObjectId GltfTextures::texture(int index, TextureUse use, const std::string& material) {
    const bool is_color = use == TextureUse::Color;
    const auto reject_texture = [&](const std::string& name, const std::string& cause) {
        builder_.notice("material '" + material + "': texture " + name + " cannot be used (" + cause + "): " +
                        (is_color ? "a magenta checkerboard replaces it" : "only the factor is used"));
        return is_color ? builder_.placeholder_texture() : ObjectId{};
    };
    const std::string number = std::to_string(index);
    const tinygltf::Texture* source = find(model_.textures, index);
    if (!source) {
        return reject_texture(number, "the file has " + std::to_string(model_.textures.size()) +
                                          " textures: correct its index");
    }
    if (source->source == -1) return reject_texture(number, "it names no image: export it as PNG or JPEG");
    const Expected<Texels>& texels = decoded(source->source, use);
    if (!texels) {
        const tinygltf::Image* image = find(model_.images, source->source);
        return reject_texture(image ? "'" + image_name(*image, source->source) + "'" : number,
                              texels.error().what());
    }
    scene::Texture texture;
    texture.width = texels->width;
    texture.height = texels->height;
    texture.format = use == TextureUse::Color ? scene::TexelFormat::Rgba8Srgb : texels->format;
    texture.texels = texels->blob;
    if (const tinygltf::Sampler* sampler = find(model_.samplers, source->sampler)) {
        texture.wrap_s = wrap(sampler->wrapS);
        texture.wrap_t = wrap(sampler->wrapT);
        if (sampler->magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST)
            texture.filter = scene::TextureFilter::Nearest;
    }
    const tinygltf::Image& image = model_.images[static_cast<std::size_t>(source->source)];
    texture.name = source->name.empty() ? image_name(image, source->source) : source->name;
    if (source->extras.IsObject() && source->extras.Has(DepthExtras)) {
        const int depth = index_member(source->extras, DepthExtras);
        if (depth >= 1 && texture.height % static_cast<std::uint32_t>(depth) == 0) {
            texture.depth = static_cast<std::uint32_t>(depth);
            texture.height /= texture.depth;
        } else {
            builder_.notice("texture '" + texture.name + "': its height is not a multiple of its " +
                            DepthExtras + ": it is used as one slice, correct it");
        }
    }
    ObjectId& result = cached_[{source->source, texture.depth, texture.format, texture.wrap_s, texture.wrap_t,
                                texture.filter}];
    if (!result) {
        result = builder_.add(std::move(texture));
        ++builder_.result().counts.textures;
    }
    return result;
}

}  // namespace tessera::import
