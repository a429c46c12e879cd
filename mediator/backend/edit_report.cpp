#include "mediator/backend/edit_report.h"

namespace tessera::backend {

namespace {

// What of a material is not drawn, or nothing.
std::string left_out(const scene::Object& object) {
    if (const auto* material = std::get_if<scene::Material>(&object)) {
        if (material->transmission > 0.0f && material->attenuation_distance > 0.0f &&
            material->thickness > 0.0f) {
            return "its body does not dim light, only its surface does";
        }
    }
    if (std::holds_alternative<scene::Medium>(object)) return "media are not drawn";
    return {};
}

}  // namespace

std::vector<std::string> MaterialProblems::update(const scene::Scene& scene, const SceneDelta& delta) {
    std::vector<std::string> problems;
    if (delta.everything) told_.clear();
    for (const ObjectId id : delta.materials) {
        const scene::Object* object = scene.find(id);
        const std::string what = object != nullptr ? left_out(*object) : std::string();
        if (what.empty()) {
            told_.erase(id);
        } else if (told_.insert(id).second) {
            problems.push_back(std::string(scene::name(scene::kind(*object))) + " " +
                               std::to_string(id.value) + " '" + scene::name(*object) + "': " + what);
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
