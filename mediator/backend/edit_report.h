#pragma once

#include <set>

#include "mediator/backend/backend.h"
#include "mediator/backend/tables/tables.h"

namespace tessera::backend {

// What to tell of materials that are drawn otherwise than they say; each once for as long as it is so.
class MaterialProblems {
  public:
    std::vector<std::string> update(const scene::Scene& scene, const SceneDelta& delta);

  private:
    std::set<ObjectId> told_;
};

// What all back-ends tell of an edit in the same way; `rebuilt` and `refitted` are those that were asked for.
EditReport make_report(const SceneDelta& delta, const MeshCatalog& meshes, const MeshCatalog::Result& changes,
                       const SceneTables& tables);

}  // namespace tessera::backend
