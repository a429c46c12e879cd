#pragma once

#include <optional>
#include <string>

#include "mediator/base/error.h"
#include "mediator/program/command_line.h"

namespace tessera::tools {

// --denoise[=NAME] and --filter NAME, which mean the same, of all commands that make pictures.
struct FilterOption {
    std::string filter;
    std::optional<std::string> denoise;

    void add_to(cli::CommandLine& command);
};

// The filter with its values, as a view takes it; "" without either option.
Expected<std::string> understand(const FilterOption& option);

}  // namespace tessera::tools
