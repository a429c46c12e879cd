#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace tessera::master {

inline constexpr std::size_t PictureChunkBytes = std::size_t{1} << 20;

// The piece of a picture that follows after `offset` bytes; empty at its end.
inline std::span<const std::byte> next_chunk(std::span<const std::byte> picture, std::size_t offset) {
    return picture.subspan(offset).first(std::min(PictureChunkBytes, picture.size() - offset));
}

}  // namespace tessera::master
