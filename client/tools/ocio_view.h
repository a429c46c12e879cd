#pragma once

#include <string>

#include "mediator/base/error.h"
#include "mediator/picture/custom_view.h"

namespace tessera::tools {

// The display and view of an OpenColorIO configuration, for `--ocio CONFIG[:DISPLAY[:VIEW]]`. Defaults: the display and view that
// the configuration names first. Rec. 709 light is converted through the role aces_interchange where the configuration has it, else
// from its colour space of linear Rec. 709 primaries, known by one of its usual names. Errors name what the configuration offers.
// A build without OpenColorIO fails with Error{InvalidInput}.
Expected<picture::CustomView> load_ocio_view(const std::string& specification);

}  // namespace tessera::tools
