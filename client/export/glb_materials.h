#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>

#include "client/export/glb_buffer.h"
#include "client/export/glb_extras.h"
#include "mediator/scene/scene.h"

namespace tinygltf {
struct Material;
class Value;
}  // namespace tinygltf

namespace tessera::exporting {

// Creates glTF materials, textures and images on demand, each once.
class GlbMaterials {
  public:
    GlbMaterials(tinygltf::Model& model, const scene::Scene& scene, GlbBuffer& buffer,
                 std::set<std::string>& notices)
        : model_(model), scene_(scene), buffer_(buffer), notices_(notices) {}

    int material(ObjectId id);  // a Material or SurfaceShader; 0: the default grey
    int medium(ObjectId id);    // its index in the file's extras; -1 = none

  private:
    tinygltf::Material make(const scene::Material& material);
    tinygltf::Material make(const scene::SurfaceShader& shader);
    WriteSlot slots();
    std::optional<tinygltf::Value> info_of(const scene::TextureSlot& slot, float scale = 1.0f);
    void add_extensions(tinygltf::Material& result, const scene::Material& material);
    std::optional<tinygltf::Value> transform_of(const scene::TextureSlot& slot);  // none: identity
    template <class Info>
    void fill(Info& info, const scene::TextureSlot& slot);
    std::optional<int> texture(ObjectId id);  // none, with a notice, if glTF cannot store it
    int image(const scene::Texture& texture);
    int sampler(const scene::Texture& texture);
    void uses(const char* extension);

    tinygltf::Model& model_;
    const scene::Scene& scene_;
    GlbBuffer& buffer_;
    std::set<std::string>& notices_;
    std::map<ObjectId, int> materials_, media_;
    std::map<ObjectId, std::optional<int>> textures_;
    std::map<std::tuple<Hash256, std::uint32_t, std::string>, int> images_;
    std::map<std::tuple<scene::Wrap, scene::Wrap, scene::TextureFilter>, int> samplers_;
};

}  // namespace tessera::exporting
