#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/scene/blob.h"
#include "mediator/scene/scene.h"

// Scenes as files. A file is there in full or not at all: it is written beside its place, flushed to the disk
// and renamed. The scene has to be valid and `blobs` has to hold what it refers to; else NotFound names what
// is missing. Io when the system does not take the file. Any thread; nothing is kept.
namespace tessera::exporting {

// What could not be said in the file's format, or only otherwise; lower-case phrases, each once.
using Notices = std::vector<std::string>;

// glTF 2.0 in one file, for other programs. Materials with their textures (PNG), lights, cameras, names and
// transforms come back from import_scene as they were, but: normals get unit length once more; shared
// transforms become copies; objects that nothing places are left out; a geometry without a material gets one
// that looks the same; a transform that has lights or cameras beside others, or geometries whose names are
// not those of one mesh's parts, gets transforms below it. What glTF has no fields for stands in extras of
// ours and comes back: sphere and quad lights (point and spot lights to others), the suns' angle, lenses,
// shadow catchers, surface shaders (to others the nearest material, nearest_material.h), media. Backgrounds,
// maps of floats, attachments, motion within the shutter and motion hints are left out and told, hints
// excepted.
// InvalidInput when it would be larger than the 4 GiB of a .glb or has more than 1,000,000 places.
Expected<Notices> write_glb(const scene::Scene& scene, const scene::BlobStore& blobs,
                            const std::filesystem::path& file);

// The whole scene to the bit, as client/import/tessera_format.h says. InvalidInput above 4 GiB.
Expected<Notices> write_tessera(const scene::Scene& scene, const scene::BlobStore& blobs,
                                const std::filesystem::path& file);

// One of the two, by the name's ending; InvalidInput for another one.
Expected<Notices> write_scene(const scene::Scene& scene, const scene::BlobStore& blobs,
                              const std::filesystem::path& file);

}  // namespace tessera::exporting
