#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// The candidate with the smallest edit distance to a misspelt word; nothing if none is close enough.
std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace tessera
