#include "client/tools/display_transform_options.h"

#include <charconv>
#include <cmath>
#include <vector>

namespace tessera::tools {

void DisplayTransformOptions::add_to(cli::CommandLine& command) {
    command.option("--exposure", "of PNG and JPEG, in EV: each step doubles the light; auto measures it once",
                   exposure);
    const auto names = enumerators(view::ViewTransform{});
    command.choice("--view-transform", "of PNG and JPEG: the curve from light to the screen", view_transform,
                   std::vector<std::string>(names.begin(), names.end()));
}

Expected<view::DisplayTransform> understand(const DisplayTransformOptions& options) {
    view::DisplayTransform transform;
    const auto names = enumerators(view::ViewTransform{});
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i] == options.view_transform)
            transform.view_transform = static_cast<view::ViewTransform>(i);
    }
    if (options.exposure == "auto") return transform;
    double value = 0.0;
    const char* const first = options.exposure.data() + (options.exposure.starts_with('+') ? 1 : 0);
    const char* const last = options.exposure.data() + options.exposure.size();
    const auto [end, problem] = std::from_chars(first, last, value);
    if (problem != std::errc{} || end != last || !(std::fabs(value) <= view::MaxExposure)) {
        return failure(ErrorCode::InvalidInput, "--exposure: '" + options.exposure +
                                                    "' is neither auto nor a number of EV from -60 to 60");
    }
    transform.exposure = value;
    return transform;
}

}  // namespace tessera::tools
