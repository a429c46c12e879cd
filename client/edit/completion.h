#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "mediator/scene/scene.h"

namespace tessera::edit {

// The candidates at the cursor, sorted; each replaces text[begin, cursor). A candidate that completes a word ends with
// a blank. Reads folders for 'load' and 'save' only.
struct Completion {
    std::size_t begin = 0;
    std::vector<std::string> candidates;
};
Completion complete(std::string_view text, std::size_t cursor, const scene::Scene& scene);

}  // namespace tessera::edit
