#pragma once

#include <string>

namespace tessera::tools {

// Text as it stands between tags and in quoted attributes of HTML and SVG.
std::string escaped(const std::string& text);

}  // namespace tessera::tools
