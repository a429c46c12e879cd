#pragma once

#include <string>

#include "mediator/session/edits.h"

namespace tessera::tools {

// The way of edits through the cluster as a file for chrome://tracing or ui.perfetto.dev: one process row for
// each client, for the master and for each node, and on them one slice for each station of each edit, named
// by its transaction. Times count from the first one there is. What is not known has no slice.
std::string chrome_trace(const std::vector<session::EditTrace>& edits);

}  // namespace tessera::tools
