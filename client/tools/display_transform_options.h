#pragma once

#include <string>

#include "mediator/base/error.h"
#include "mediator/program/command_line.h"
#include "mediator/view/display_transform.h"

namespace tessera::tools {

// --exposure and --view-transform, of all commands that write PNG or JPEG, or show pictures.
struct DisplayTransformOptions {
    std::string exposure = "auto", view_transform = "neutral";

    void add_to(cli::CommandLine& command);
};
Expected<view::DisplayTransform> understand(const DisplayTransformOptions& options);

}  // namespace tessera::tools
