#pragma once

#include <string>

namespace tessera::tools {

// Escapes text for HTML and SVG, both between tags and in quoted attributes.
std::string escaped(const std::string& text);

}  // namespace tessera::tools
