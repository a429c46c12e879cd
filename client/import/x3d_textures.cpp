#include "client/import/x3d_textures.h"

#include <algorithm>
#include <charconv>

#include "client/import/image_decoder.h"
#include "client/import/limits.h"
#include "client/import/x3d_fields.h"

namespace tessera::import {
namespace {

// Percent-decoding; invalid codes are kept.
std::string decoded_address(const std::string& address) {
    std::string name;
    for (std::size_t i = 0; i < address.size(); ++i) {
        unsigned code = 0;
        const char* digits = address.data() + i + 1;
        if (address[i] == '%' && i + 2 < address.size() &&
            std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2) {
            name += static_cast<char>(code);
            i += 2;
        } else {
            name += address[i] == '\\' ? '/' : address[i];
        }
    }
    return name.starts_with("./") ? name.substr(2) : name;
}

X3dTextures::Traits traits_of(const std::vector<std::uint8_t>& rgba) {
    X3dTextures::Traits traits{.is_grey = true, .has_opacity = false};
    for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
        traits.is_grey &= rgba[i] == rgba[i + 1] && rgba[i] == rgba[i + 2];
        traits.has_opacity |= rgba[i + 3] != 255;
    }
    return traits;
}

}  // namespace

Expected<X3dTextures::Picture> X3dTextures::decode(const std::string& name) {
    const auto bytes = folder_.read(name);
    if (!bytes) return tl::unexpected<Error>(bytes.error());
    const Expected<DecodedImage> image = decode_image(*bytes);
    if (!image)
        return failure(ErrorCode::InvalidInput, "'" + name.substr(0, 100) + "': " + image.error().what());
    return Picture{image->width, image->height, builder_.blob(image->rgba), traits_of(image->rgba)};
}

const Expected<X3dTextures::Picture>& X3dTextures::decoded(const std::string& name) {
    const auto found = pictures_.find(name);
    return found != pictures_.end() ? found->second : pictures_.emplace(name, decode(name)).first->second;
}

const X3dTextures::Found& X3dTextures::found(pugi::xml_node image) {
    const auto [entry, is_new] = found_.try_emplace(image.internal_object());
    Found& found = entry->second;
    if (!is_new) return found;
    const X3dFields fields(image, document_.diagnostics());
    for (const std::string& address : fields.strings("url")) {
        if (address.find("://") != address.npos) continue;  // remote copies are common in X3D files
        found.name = decoded_address(address);
        const Expected<Picture>& picture = decoded(found.name);
        if (picture) {
            found.picture = *picture;
            return found;
        }
        if (found.cause.empty()) found.cause = picture.error().what();
    }
    if (found.cause.empty()) found.cause = "it names no image in the scene's folder";
    return found;
}

X3dTextures::Traits X3dTextures::traits(pugi::xml_node image) {
    const Found& found = this->found(image);
    return found.picture ? found.picture->traits : Traits{};
}

// Of data, as in glTF files: steps of eight bits are seen in mirrors.
void X3dTextures::keep_sixteen_bits(scene::Texture& texture, const std::string& file) const {
    const auto bytes = folder_.read(file);
    if (!bytes) return;
    const auto image = picture::read_png16(std::as_bytes(std::span(*bytes)), ImageLimits);
    if (!image || !*image) return;
    texture.format = scene::TexelFormat::RgbFloat;
    texture.texels = builder_.blob((*image)->values);
}

ObjectId X3dTextures::texture(pugi::xml_node image, TextureUse use, const std::string& owner) {
    const Found& found = this->found(image);
    const X3dFields fields(image, document_.diagnostics());
    if (!found.picture) {
        const bool is_color = use == TextureUse::Color;
        fields.report("of " + owner + " cannot be used (" + found.cause +
                      "): " + (is_color ? "a magenta checkerboard replaces it" : "only the factor is used"));
        return is_color ? builder_.placeholder_texture() : ObjectId{};
    }
    ObjectId& result = cached_[{image.internal_object(), use}];
    if (result) return result;
    scene::Texture texture;
    texture.name = x3d_name(image).empty() ? found.name : x3d_name(image);
    texture.width = found.picture->width;
    texture.height = found.picture->height;
    texture.format = use == TextureUse::Color ? scene::TexelFormat::Rgba8Srgb : scene::TexelFormat::Rgba8;
    texture.wrap_s = fields.flag("repeatS", true) ? scene::Wrap::Repeat : scene::Wrap::Clamp;
    texture.wrap_t = fields.flag("repeatT", true) ? scene::Wrap::Repeat : scene::Wrap::Clamp;
    texture.texels = found.picture->texels;
    if (use == TextureUse::Data) keep_sixteen_bits(texture, found.name);
    result = builder_.add(std::move(texture));
    ++builder_.result().counts.textures;
    return result;
}

}  // namespace tessera::import
