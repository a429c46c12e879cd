#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/picture/custom_view.h"
#include "mediator/program/command_line.h"
#include "mediator/view/display_transform.h"

namespace tessera::tools {

// --exposure, --view-transform and --ocio of all commands that write PNG or JPEG, or show pictures.
struct DisplayTransformOptions {
    std::string exposure = "auto", view_transform = "neutral", ocio;

    void add_to(cli::CommandLine& command);
};
struct DisplayChoice {
    view::DisplayTransform transform;
    std::optional<picture::CustomView> custom;  // of --ocio
    const picture::CustomView* custom_view() const { return custom ? &*custom : nullptr; }
};
// "--exposure has no effect on EXR files ...", if only those are written and an option was given; else nothing.
std::optional<std::string> unused_display_options(const DisplayTransformOptions& options,
                                                  const std::vector<std::string>& outputs);
Expected<DisplayChoice> parse_options(const DisplayTransformOptions& options);

}  // namespace tessera::tools
