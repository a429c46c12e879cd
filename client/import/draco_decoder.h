#pragma once

#include <cstdint>
#include <memory>
#include <span>

namespace draco {
class Mesh;
}

namespace tessera::import {

// Decodes a Draco mesh of at most `most_faces` triangles, MaxDracoFaces and MaxDracoFacesPerByte. The counts that the
// data states are checked before Draco allocates for them, the actual ones and the corners of all triangles afterwards.
// Throws Error{InvalidInput} whose message begins with "its Draco data".
std::unique_ptr<draco::Mesh> decode_draco_mesh(std::span<const unsigned char> bytes,
                                               std::uint64_t most_faces);

}  // namespace tessera::import
