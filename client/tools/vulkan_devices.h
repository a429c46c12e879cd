#pragma once

#include "client/tools/findings.h"

namespace tessera::tools {

// One finding for every Vulkan device, also for those that the back-end refuses, with the reasons; one that
// says so where there is none or where the back-end was not built.
void examine_vulkan(Findings& findings);

}  // namespace tessera::tools
