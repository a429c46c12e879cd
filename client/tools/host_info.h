#pragma once

#include <cstdint>
#include <string>

namespace tessera::tools {

std::string host_name();
std::uint32_t core_count();          // that this process may use; at least 1
std::uint64_t peak_memory_bytes();   // of this process so far
std::uint64_t total_memory_bytes();  // of the machine

}  // namespace tessera::tools
