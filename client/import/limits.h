#pragma once

#include <cstddef>
#include <cstdint>

#include "mediator/picture/picture_limits.h"

// Limits for scene files: generous for real scenes, small enough to reject malformed files before they
// exhaust memory.
namespace tessera::import {

inline constexpr std::uint64_t MaxFileBytes = 0xffffffffull;      // the maximum of a GLB's length field
inline constexpr std::uint64_t MaxElements = 1ull << 28;          // of one array: vertices or indices
inline constexpr std::uint64_t MaxPointsOrLines = 1ull << 22;     // of one mesh
inline constexpr std::uint64_t MaxUnbackedElements = 1ull << 20;  // of an accessor of zeros without a buffer
inline constexpr std::uint64_t MaxDracoFaces = 1ull << 24;        // of one compressed mesh
inline constexpr std::uint64_t MaxDracoFacesPerByte = 4096;       // regular grids have hundreds
inline constexpr std::uint64_t MaxDecodedBytes = 8ull << 30;      // of all arrays and texels together
inline constexpr std::uint64_t MaxInstances = 4'000'000;          // of geometries
inline constexpr std::uint32_t MaxImageEdge = 16384;              // pixels
inline constexpr std::uint64_t MaxImagePixels = 1ull << 27;
inline constexpr std::uint64_t MaxJpegScans = 500;
inline constexpr std::uint64_t MaxJpegScanPixels = 1ull << 31;  // pixels of all scans together, about 20 s
inline constexpr picture::PictureLimits ImageLimits{.side = MaxImageEdge, .pixels = MaxImagePixels};
inline constexpr std::size_t MaxNesting = 512;      // of nodes
inline constexpr std::size_t MaxTextNesting = 200;  // of JSON arrays and objects

}  // namespace tessera::import
