#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/scene/blob.h"
#include "mediator/scene/change_list.h"

// The scene file of our own, ".tessera": everything that a scene is, to the bit. Little-endian:
//
//   offset  bytes
//        0      8  89 54 53 52 0d 0a 1a 0a: not text, and damaged by whatever takes it for text
//        8      4  format version, 1
//       12      4  number of blobs, B
//       16      8  size of the change list in bytes, C
//       24      C  change list: a snapshot of the scene, encoded as on the wire (proto/scene.proto,
//       ChangeList)
//                  B times, ascending by hash, each of what the scene refers to and nothing else:
//               32   BLAKE2b-256 of the blob's bytes
//                8   their number, N (not 0)
//                N   the bytes
//   the last   32  BLAKE2b-256 of everything before it
//
// A reader refuses other versions. The snapshot's version (epoch and number) is the one that was saved.
namespace tessera::import {

inline constexpr std::array<std::uint8_t, 8> TesseraMagic{0x89, 'T', 'S', 'R', '\r', '\n', 0x1a, '\n'};
inline constexpr std::uint32_t TesseraFormatVersion = 1;
inline constexpr std::size_t TesseraHeaderBytes = 24;

struct TesseraFile {
    scene::ChangeList snapshot;         // applies to an empty Scene, which is then valid
    std::vector<scene::BlobPtr> blobs;  // all that it refers to, each once, valid
};

// Reads and checks everything: frame, checksum, snapshot, the scene's validity, the content of its blobs.
// InvalidInput says what is wrong, NotFound and Io as read_whole_file.
Expected<TesseraFile> read_tessera(const std::filesystem::path& file);

}  // namespace tessera::import
