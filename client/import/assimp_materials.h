#pragma once

#include <map>
#include <string>

#include "client/import/local_files.h"
#include "client/import/scene_builder.h"

struct aiMesh;
struct aiScene;

namespace tessera::import {

// Materials of formats older than glTF: diffuse colour and texture, opacity, emission; a specular exponent n
// becomes the roughness of equal width, alpha^2 = 2 / (n + 2) (Walter et al. 2007).
class AssimpMaterials {
  public:
    AssimpMaterials(const aiScene& source, const LocalFolder& folder, SceneBuilder& builder)
        : source_(source), folder_(folder), builder_(builder) {}

    ObjectId material(const aiMesh& mesh);

  private:
    ObjectId make(unsigned index, const aiMesh& mesh);
    ObjectId texture(const std::string& name, const std::string& material);

    const aiScene& source_;
    const LocalFolder& folder_;
    SceneBuilder& builder_;
    std::map<std::pair<unsigned, bool>, ObjectId>
        materials_;  // by index and whether the mesh has vertex colours
    std::map<std::string, ObjectId> textures_;
};

}  // namespace tessera::import
