#pragma once

#include <string>
#include <string_view>

namespace tessera::exporting {

// Replaces invalid UTF-8 by U+FFFD, as JSON requires UTF-8.
std::string utf8(std::string_view text);

}  // namespace tessera::exporting
