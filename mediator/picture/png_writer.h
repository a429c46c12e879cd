#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tessera::picture {

// 8-bit sRGB, 3 bytes a pixel. The file is never incomplete; throws Error{Io}.
void write_png(const std::string& path, std::uint32_t width, std::uint32_t height,
               std::span<const std::uint8_t> rgb);

// The same as a file in memory.
std::vector<std::byte> encode_png(std::uint32_t width, std::uint32_t height,
                                  std::span<const std::uint8_t> rgb);

// With unpremultiplied alpha, 4 bytes a pixel.
std::vector<std::byte> encode_rgba_png(std::uint32_t width, std::uint32_t height,
                                       std::span<const std::uint8_t> rgba);

// 16 bits, 3 values a pixel in [0, 1]; others are clamped.
std::vector<std::byte> encode_png16(std::uint32_t width, std::uint32_t height, std::span<const float> rgb);

}  // namespace tessera::picture
