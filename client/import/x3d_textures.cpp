#include "client/import/x3d_textures.h"

#include <algorithm>
#include <charconv>

#include "client/import/image_decoder.h"
#include "client/import/x3d_fields.h"

namespace tessera::import {
namespace {

// %20 and the like; what is no such code stays.
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

std::optional<X3dTextures::Picture> X3dTextures::decoded(const std::string& name, std::string& cause) {
    const auto [place, is_new] = pictures_.try_emplace(name);
    if (!is_new) return place->second;
    const auto bytes = folder_.read(name);
    if (!bytes) {
        cause = bytes.error().what();
    } else if (const Expected<DecodedImage> image = decode_image(*bytes)) {
        place->second =
            Picture{image->width, image->height, builder_.blob(image->rgba), traits_of(image->rgba)};
    } else {
        cause = "'" + name.substr(0, 100) + "': " + image.error().what();
    }
    return place->second;
}

const X3dTextures::Found& X3dTextures::found(pugi::xml_node image) {
    const auto [place, is_new] = found_.try_emplace(image.internal_object());
    Found& found = place->second;
    if (!is_new) return found;
    const X3dFields fields(image, document_.problems());
    std::string first_cause;
    for (const std::string& address : fields.strings("url")) {
        if (address.find("://") != address.npos)
            continue;  // another copy far away, as X3D files like to name
        found.name = decoded_address(address);
        std::string cause;
        found.picture = decoded(found.name, cause);
        if (found.picture) return found;
        if (first_cause.empty()) first_cause = cause;
    }
    if (first_cause.empty()) first_cause = "it names no picture in the scene's folder";
    fields.problem("cannot be used (" + first_cause +
                   "): a magenta checker or the plain factor stands for it");
    return found;
}

X3dTextures::Traits X3dTextures::traits(pugi::xml_node image) {
    const Found& found = this->found(image);
    return found.picture ? found.picture->traits : Traits{};
}

ObjectId X3dTextures::texture(pugi::xml_node image, TextureUse use) {
    const Found& found = this->found(image);
    if (!found.picture) return use == TextureUse::Color ? builder_.placeholder_texture() : ObjectId{};
    ObjectId& made = made_[{image.internal_object(), use}];
    if (made) return made;
    const X3dFields fields(image, document_.problems());
    scene::Texture texture;
    texture.name = x3d_name(image).empty() ? found.name : x3d_name(image);
    texture.width = found.picture->width;
    texture.height = found.picture->height;
    texture.format = use == TextureUse::Color ? scene::TexelFormat::Rgba8Srgb : scene::TexelFormat::Rgba8;
    texture.wrap_s = fields.flag("repeatS", true) ? scene::Wrap::Repeat : scene::Wrap::Clamp;
    texture.wrap_t = fields.flag("repeatT", true) ? scene::Wrap::Repeat : scene::Wrap::Clamp;
    texture.texels = found.picture->texels;
    made = builder_.add(std::move(texture));
    ++builder_.result().counts.textures;
    return made;
}

}  // namespace tessera::import
