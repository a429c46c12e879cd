#include "mediator/backend/edit_report.h"

namespace tessera::backend {

EditReport make_report(const SceneDelta& delta, const MeshCatalog& meshes, const MeshCatalog::Result& changes,
                       const SceneTables& tables) {
    EditReport report{.entries = delta.entries,
                      .relevant = delta.relevant,
                      .rebuilt = changes.count(MeshUpdate::Rebuild),
                      .refitted = changes.count(MeshUpdate::Refit),
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
