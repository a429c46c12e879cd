#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tessera::edit {

// The manual of the language. `topic`: "" for the overview, a command, a kind of object (its fields), or one
// of help_topics(). "" when there is no such topic.
std::string help_text(std::string_view topic);
const std::vector<std::string>& help_topics();  // in addition to commands and kinds
std::string whole_manual();                     // everything, one after another

}  // namespace tessera::edit
