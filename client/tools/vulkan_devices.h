#pragma once

#include "client/tools/diagnostics.h"

namespace tessera::tools {

// Adds one diagnostic per Vulkan device, including those that the back-end refuses (with the reasons), or a single
// one if there is no device or the back-end was not built.
void examine_vulkan(Diagnostics& diagnostics);

}  // namespace tessera::tools
