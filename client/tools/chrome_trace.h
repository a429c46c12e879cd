#pragma once

#include <string>

#include "mediator/session/edits.h"

namespace tessera::tools {

// Traces of edits through the cluster, as JSON for chrome://tracing or ui.perfetto.dev: one process row for each client,
// the master and each node, with one slice per stage of each edit, named by its transaction. Times are relative to the
// first event. Stages with unknown times are omitted.
std::string chrome_trace(const std::vector<session::EditTrace>& edits);

}  // namespace tessera::tools
