#pragma once

#include <map>
#include <optional>
#include <tuple>

#include "client/import/local_files.h"
#include "client/import/scene_builder.h"
#include "client/import/texture_use.h"
#include "client/import/x3d_document.h"

namespace tessera::import {

// Creates Texture objects from ImageTexture nodes: one per node and colour space. The first URL that is an
// image in the scene's folder is used; nothing is downloaded. Each file is decoded once.
class X3dTextures {
  public:
    X3dTextures(X3dDocument& document, LocalFolder folder, SceneBuilder& builder)
        : document_(document), folder_(std::move(folder)), builder_(builder) {}

    // 0 for invalid data. `owner`: the label of the node that uses the texture, for messages.
    ObjectId texture(pugi::xml_node image, TextureUse use, const std::string& owner);

    // Traits of the image; all false if it is invalid.
    struct Traits {
        bool is_grey = false;      // in all texels
        bool has_opacity = false;  // some texel is not opaque
    };
    Traits traits(pugi::xml_node image);

  private:
    struct Picture {
        std::uint32_t width = 0, height = 0;
        scene::BlobRef texels;
        Traits traits;
    };
    struct Found {
        std::string name;
        std::optional<Picture> picture;
        std::string cause;  // why it could not be loaded
    };
    const Found& found(pugi::xml_node image);
    const Expected<Picture>& decoded(const std::string& name);
    Expected<Picture> decode(const std::string& name);
    void keep_sixteen_bits(scene::Texture& texture, const std::string& file) const;

    X3dDocument& document_;
    LocalFolder folder_;
    SceneBuilder& builder_;
    std::map<std::string, Expected<Picture>> pictures_;
    std::map<const void*, Found> found_;
    std::map<std::pair<const void*, TextureUse>, ObjectId> cached_;
};

}  // namespace tessera::import
