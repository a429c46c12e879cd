#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/scene/blob.h"
#include "mediator/scene/change_list.h"

// Tessera's scene file, ".tessera": a complete, bit-exact scene. Little-endian:
//
//   offset  bytes
//        0      8  89 54 53 52 0d 0a 1a 0a: not text, and detects conversions of line ends
//        8      4  format version, 1
//       12      4  number of blobs, B
//       16      8  size of the change list in bytes, C
//       24      C  change list: a snapshot of the scene, encoded as on the wire (proto/scene.proto,
//       ChangeList)
//                  B times, ascending by hash, exactly the blobs that the scene refers to:
//               32   BLAKE2b-256 of the blob's bytes
//                8   number of bytes, N (not 0)
//                N   the bytes
//   the last   32  BLAKE2b-256 of everything before it
//
// Readers reject other versions. The snapshot keeps its version (epoch and number).
namespace tessera::import {

inline constexpr std::array<std::uint8_t, 8> TesseraMagic{0x89, 'T', 'S', 'R', '\r', '\n', 0x1a, '\n'};
inline constexpr std::uint32_t TesseraFormatVersion = 1;
inline constexpr std::size_t TesseraHeaderBytes = 24;

struct TesseraFile {
    scene::ChangeList snapshot;         // applies to an empty Scene, which is then valid
    std::vector<scene::BlobPtr> blobs;  // all that it refers to, each once, validated
};

// Reads and validates everything: header, checksum, snapshot, scene, contents of blobs.
// InvalidInput says what is wrong, NotFound and Io as in read_whole_file.
Expected<TesseraFile> read_tessera(const std::filesystem::path& file);

}  // namespace tessera::import
