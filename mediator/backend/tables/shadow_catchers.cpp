#include "mediator/backend/tables/parts.h"

namespace tessera::backend {

void mark_shadow_catchers(SceneTables& tables, const scene::Scene& scene, const FlatScene& flat_scene,
                          const MeshCatalog& meshes) {
    for (std::size_t i = 0; i < tables.instances.size(); ++i) {
        const Mesh& mesh = *meshes.find(flat_scene.instances[i].geometry);
        const auto* source = scene.find_as<scene::Material>(mesh.source.material);
        if (source == nullptr || !source->shadow_catcher || mesh.placeholder) continue;
        shading::Instance& instance = tables.instances[i];
        instance.light = shading::ShadowCatcher;
        instance.alpha_tested = 1;
        shading::Material& material = tables.materials[instance.material];
        material.thin &= ~shading::ThinClear;
        if (material.alpha_mode == shading::AlphaOpaque) material.alpha_mode = shading::AlphaBlend;
        tables.scene.features |= shading::FeatureAlpha | shading::FeatureShadowCatcher;
    }
}

}  // namespace tessera::backend
