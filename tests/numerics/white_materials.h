#pragma once

#include <vector>

#include "tests/statistics/scene_model.h"

namespace tessera::test {

// One material of each lobe, white.
struct WhiteMaterial {
    const char* name;
    scene::Material material;
    bool is_clear = false;  // lossless: as bright as the sky
};

inline const std::vector<WhiteMaterial>& white_materials() {
    static const std::vector<WhiteMaterial> all = [] {
        const glm::vec4 white(1.0f);
        const scene::Material rough{.base_color = white, .roughness = 0.4f, .double_sided = true};
        std::vector<WhiteMaterial> made{{"dielectric", rough}};
        made.push_back({"metal", rough});
        made.back().material.metallic = 1.0f;
        made.push_back({"mirror", mirror(glm::vec3(1.0f)), true});
        made.push_back({"brushed", rough});
        made.back().material.metallic = 1.0f;
        made.back().material.anisotropy = 0.8f;
        made.push_back({"coat", rough});
        made.back().material.clearcoat = 1.0f;
        made.back().material.clearcoat_roughness = 0.3f;
        made.push_back({"smooth coat", rough});
        made.back().material.clearcoat = 1.0f;
        made.push_back({"sheen", rough});
        made.back().material.sheen_color = glm::vec3(1.0f);
        made.back().material.sheen_roughness = 0.5f;
        made.push_back({"film", rough});
        made.back().material.iridescence = 1.0f;
        made.push_back({"clear glass", glass(1.5f), true});
        made.push_back({"rough glass", glass(1.5f)});
        made.back().material.roughness = 0.4f;
        return made;
    }();
    return all;
}

}  // namespace tessera::test
