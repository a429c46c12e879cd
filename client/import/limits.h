#pragma once

#include <cstddef>
#include <cstdint>

// What a scene file may ask of us. Generous for real scenes, small enough that a hostile one is refused
// before it takes the machine's memory.
namespace tessera::import {

inline constexpr std::uint64_t MaxFileBytes = 0xffffffffull;      // a GLB's own length field ends here
inline constexpr std::uint64_t MaxElements = 1ull << 28;          // of one array: vertices or indices
inline constexpr std::uint64_t MaxThinBodies = 1ull << 22;        // of one mesh: its points or lines
inline constexpr std::uint64_t MaxUnbackedElements = 1ull << 20;  // of an array of zeros that no buffer backs
inline constexpr std::uint64_t MaxDecodedBytes = 8ull << 30;      // of all arrays and texels together
inline constexpr std::uint64_t MaxInstances = 4'000'000;          // geometries as placed
inline constexpr std::uint32_t MaxImageEdge = 16384;              // pixels
inline constexpr std::uint64_t MaxImagePixels = 1ull << 27;
inline constexpr std::size_t MaxNesting = 512;      // of nodes
inline constexpr std::size_t MaxTextNesting = 200;  // of JSON arrays and objects

}  // namespace tessera::import
