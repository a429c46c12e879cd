#include "mediator/backend/edit_report.h"

#include "mediator/shading/bsdf.h"

namespace tessera::backend {

// Rough transmission is drawn as smooth.
std::vector<std::string> MaterialProblems::update(const scene::Scene& scene, const SceneDelta& delta) {
    std::vector<std::string> problems;
    if (delta.everything) told_.clear();
    for (const ObjectId id : delta.materials) {
        const auto* material = scene.find_as<scene::Material>(id);
        const bool rough = material != nullptr && material->transmission > 0.0f &&
                           material->metallic < 1.0f &&
                           material->roughness * material->roughness > shading::MinAlpha;
        if (!rough) {
            told_.erase(id);
        } else if (told_.insert(id).second) {
            problems.push_back("material " + std::to_string(id.value) + " '" + material->name +
                               "': its rough transmission is drawn as smooth");
        }
    }
    return problems;
}

EditReport make_report(const SceneDelta& delta, const MeshCatalog& meshes, const MeshCatalog::Result& changes,
                       const SceneTables& tables) {
    EditReport report{.entries = delta.entries,
                      .relevant = delta.relevant,
                      .rebuilt = changes.count(MeshStep::Rebuild),
                      .refitted = changes.count(MeshStep::Refit),
                      .instances = tables.instances.size(),
                      .lights = tables.lights.size(),
                      .ignored_kinds = delta.ignored_kinds,
                      .problems = changes.problems};
    for (const auto& [id, mesh] : meshes.all()) {
        report.triangles += elements<glm::uvec3>(mesh.triangles).size();
        report.degenerate_triangles += mesh.degenerate_triangles;
    }
    return report;
}

}  // namespace tessera::backend
