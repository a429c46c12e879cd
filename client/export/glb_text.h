#pragma once

#include <string>
#include <string_view>

namespace tessera::exporting {

// JSON is UTF-8: what is not becomes U+FFFD.
std::string utf8(std::string_view text);

}  // namespace tessera::exporting
