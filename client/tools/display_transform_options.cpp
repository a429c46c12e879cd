#include "client/tools/display_transform_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "client/tools/ocio_view.h"
#include "client/tools/pictures.h"

namespace tessera::tools {

void DisplayTransformOptions::add_to(cli::CommandLine& command) {
    command.option("--exposure",
                   "exposure of PNG and JPEG in EV (+1 doubles the brightness); auto measures it once",
                   exposure);
    const auto names = enumerators(view::ViewTransform{});
    command.choice("--view-transform", "view transform (tone curve) of PNG and JPEG", view_transform,
                   std::vector<std::string>(names.begin(), names.end()));
    command.option(
        "--ocio",
        "OpenColorIO view of PNG and JPEG instead: CONFIG[:DISPLAY[:VIEW]]; defaults are the configuration's",
        ocio);
}

Expected<DisplayChoice> parse_options(const DisplayTransformOptions& options) {
    DisplayChoice choice;
    view::DisplayTransform& transform = choice.transform;
    if (!options.ocio.empty()) {
        auto custom = load_ocio_view(options.ocio);
        if (!custom) return tl::unexpected(custom.error());
        choice.custom = std::move(*custom);
    }
    const auto names = enumerators(view::ViewTransform{});
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i] == options.view_transform)
            transform.view_transform = static_cast<view::ViewTransform>(i);
    }
    if (options.exposure == "auto") return choice;
    double value = 0.0;
    const char* const first = options.exposure.data() + (options.exposure.starts_with('+') ? 1 : 0);
    const char* const last = options.exposure.data() + options.exposure.size();
    const auto [end, problem] = std::from_chars(first, last, value);
    if (problem != std::errc{} || end != last || !(std::fabs(value) <= view::MaxExposure)) {
        return failure(ErrorCode::InvalidInput, "--exposure: '" + options.exposure +
                                                    "' is neither auto nor a number of EV from -60 to 60");
    }
    transform.exposure = value;
    return choice;
}

std::optional<std::string> unused_display_options(const DisplayTransformOptions& options,
                                                  const std::vector<std::string>& outputs) {
    const DisplayTransformOptions defaults;
    const char* given = options.exposure != defaults.exposure               ? "--exposure"
                        : options.view_transform != defaults.view_transform ? "--view-transform"
                        : !options.ocio.empty()                             ? "--ocio"
                                                                            : nullptr;
    const bool only_exr = !outputs.empty() && std::ranges::all_of(outputs, [](const std::string& path) {
        return picture_format(path) == PictureFormat::Exr;
    });
    if (given == nullptr || !only_exr) return std::nullopt;
    return std::string(given) + " has no effect on EXR files, which keep linear light: add -o FILE.png";
}

}  // namespace tessera::tools
