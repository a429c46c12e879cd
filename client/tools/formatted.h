#pragma once

#include <cstdio>
#include <string>

namespace tessera::tools {

// printf to a string of at most 400 characters.
template <class... Values>
std::string formatted(const char* format, Values... values) {
    char text[400];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

}  // namespace tessera::tools
