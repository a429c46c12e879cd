#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/scene/blob.h"
#include "mediator/scene/scene.h"

// Saves scenes to files, atomically: a temporary file in the same folder is written, flushed to disk and
// renamed. The scene must be valid and `blobs` must contain the blobs it refers to; else NotFound names the
// missing one. Io if the file cannot be written. Any thread; stateless.
namespace tessera::exporting {

// About what the file format cannot express; each once.
using Notices = std::vector<std::string>;

// glTF 2.0 in one file, for other programs. Materials with their textures (PNG), lights, cameras, names and
// transforms are restored by import_scene, with these exceptions: normals are normalized again; shared
// transforms become copies; unreferenced objects are left out; a geometry without a material gets an
// equivalent one; a transform with several lights or cameras, or with geometries that are not named as the
// parts of one mesh, gets child transforms. Properties that glTF lacks are stored in extras and restored:
// sphere and quad lights (point and spot lights for other programs), the angular diameter of directional
// lights, lenses, shadow catchers, surface shaders (for other programs the nearest material,
// nearest_material.h), media. Backgrounds, floating-point textures, attachments and motion keys are left out
// with a notice, motion hints without. InvalidInput if it would exceed the 4 GiB of a .glb or has more than
// 1,000,000 nodes.
Expected<Notices> write_glb(const scene::Scene& scene, const scene::BlobStore& blobs,
                            const std::filesystem::path& file);

// The complete scene, bit-exact, in the format of client/import/tessera_format.h. InvalidInput above 4 GiB.
Expected<Notices> write_tessera(const scene::Scene& scene, const scene::BlobStore& blobs,
                                const std::filesystem::path& file);

// One of the two, by the file extension; InvalidInput for others.
Expected<Notices> write_scene(const scene::Scene& scene, const scene::BlobStore& blobs,
                              const std::filesystem::path& file);

}  // namespace tessera::exporting
