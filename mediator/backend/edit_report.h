#pragma once

#include "mediator/backend/backend.h"
#include "mediator/backend/tables/tables.h"

namespace tessera::backend {

// What all back-ends tell of an edit in the same way; `rebuilt` and `refitted` are those that were asked for.
EditReport make_report(const SceneDelta& delta, const MeshCatalog& meshes, const MeshCatalog::Result& changes,
                       const SceneTables& tables);

}  // namespace tessera::backend
