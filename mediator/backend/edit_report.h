#pragma once

#include "mediator/backend/backend.h"
#include "mediator/backend/tables/tables.h"

namespace tessera::backend {

// The part of the report that is the same for all back-ends; `rebuilt` and `refitted` are the requested updates.
EditReport make_report(const SceneDelta& delta, const MeshCatalog& meshes, const MeshCatalog::Result& changes,
                       const SceneTables& tables);

}  // namespace tessera::backend
