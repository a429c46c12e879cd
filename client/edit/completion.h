#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "mediator/scene/scene.h"

namespace tessera::edit {

// What may stand at the cursor: each candidate takes the place of text[begin, cursor). Sorted. A candidate
// that ends a word has a blank behind it. Looks into folders for 'load' and 'save', else only at its
// arguments.
struct Completion {
    std::size_t begin = 0;
    std::vector<std::string> candidates;
};
Completion complete(std::string_view text, std::size_t cursor, const scene::Scene& scene);

}  // namespace tessera::edit
