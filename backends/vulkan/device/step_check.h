#pragma once

#include <cstdint>
#include <string>

namespace tessera::vulkan {

class Buffer;

// Both throw Error{Internal} for an invalid step.
void require(bool holds, const std::string& what);
void check_range(const Buffer* buffer, std::uint64_t offset, std::uint64_t bytes, const std::string& step);

}  // namespace tessera::vulkan
