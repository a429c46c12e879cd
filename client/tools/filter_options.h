#pragma once

#include <optional>
#include <string>

#include "mediator/base/error.h"
#include "mediator/program/command_line.h"

namespace tessera::tools {

// Of --denoise without a name, and of live views without an option: a history makes all the difference while the camera
// moves at one sample per pixel.
inline constexpr const char *RecommendedFilter = "fdf", *LiveFilter = "psvgf";

// --denoise[=NAME] and --filter NAME, which are synonyms, for all commands that write pictures.
struct FilterOption {
    std::string filter;
    std::optional<std::string> denoise;

    void add_to(cli::CommandLine& command);
};

// The filter and its parameters in the format of View::filter; "" without either option.
Expected<std::string> parse_options(const FilterOption& option);

// The filter, in the format of View::filter, runs in this process. Unavailable: what is missing on this machine.
Expected<void> check_available(const std::string& filter);

// InvalidInput if a reproducible frame cannot have the filter.
Expected<void> check_reproducible(const std::string& filter);
Expected<void> check_error_estimate(const std::string& filter);  // for --error

}  // namespace tessera::tools
