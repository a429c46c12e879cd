#pragma once

#include <string_view>

namespace tessera::tools::bench {

// The Python program that Blender runs.
std::string_view cycles_script();

}  // namespace tessera::tools::bench
