#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/scene/blob.h"
#include "mediator/scene/change_list.h"

namespace tessera::import {

struct Playback;

// A camera where the file has none, and a soft sky where nothing shines: added for who wants to see the
// scene, left to who brings it into another.
enum class Missing { Add, Leave };

// Whether the scene is to be brought to other times with move_to.
enum class Motion { Still, Sequence };
// What glTF's glass without KHR_materials_volume is: thin walls, as the extension has it, or a body that
// refracts, as the programs show it that most such files come from.
enum class Glass { Thin, Solid };

struct ImportOptions {
    ObjectId first_id{2};                 // objects get consecutive ids from here
    ObjectId end_id{1ull << 32};          // one past the last id that may be used
    std::optional<glm::vec3> background;  // linear radiance; counts as light when not black
    std::filesystem::path environment;    // latitude-longitude .exr or .hdr; empty = none
    float environment_strength = 1.0f;
    Missing missing = Missing::Add;
    std::optional<double> at;  // seconds into the animations; none = at rest, as without them
    double shutter = 0.0;      // seconds that it is open, from `at` on: what is animated moves meanwhile
    std::string animation;     // only this one, by its name, else its number; "" = all together
    Motion motion = Motion::Still;
    Glass glass = Glass::Thin;
    // Width / height of the pictures that a camera is made for where the file has none: in those, and in
    // wider ones, all is seen.
    double aspect_ratio = 1.0;
};

// A place to look from; the Camera object is in the scene, too.
struct CameraInfo {
    std::string name;                   // unique
    glm::dmat4 world_from_camera{1.0};  // rigid; looks along -z, y up
    scene::Camera camera;               // its values
    std::vector<glm::dmat4> motion;     // world_from_camera at steps of time, as scene::Transform::motion
};

struct AnimationInfo {
    std::string name;
    double seconds = 0.0;  // time of its last key
};

struct ImportCounts {
    std::uint64_t triangles = 0;             // of all geometries, each once
    std::uint64_t degenerate_triangles = 0;  // among them: kept, without area
    std::uint64_t geometries = 0;
    std::uint64_t instances = 0;  // geometries as placed
    std::uint64_t lights = 0;     // as placed: point, spot and directional
    std::uint64_t emissive_geometries = 0;
    std::uint64_t textures = 0;
    std::uint64_t placeholders = 0;  // meshes and textures that were bad and are shown in magenta
};

// What a file becomes: values, nothing shared with the file. The same file and options give the same ids and
// bytes.
struct ImportedScene {
    scene::Root root;                    // children and background; its id is scene::RootId
    std::vector<scene::Create> objects;  // all others, ids ascending and consecutive from first_id
    std::vector<scene::BlobPtr> blobs;   // all that the objects refer to, each once
    std::vector<CameraInfo> cameras;     // the file's own in file order, else the one that was added
    std::vector<std::string> notices;    // what was added, replaced or ignored; lower-case phrases, each once
    ImportCounts counts;
    std::vector<AnimationInfo> animations;  // of the file, played or not
    std::vector<std::string> extensions;  // of glTF that the file uses; those that are not read have a notice
    std::vector<std::string> variants;    // names of KHR_materials_variants; the default look is imported
    // Geometries that are not among the children of a transform while it leaves them no volume.
    std::map<ObjectId, std::vector<ObjectId>> without_volume;
    std::optional<double> seconds;             // the time it shows; none = at rest
    double shutter = 0.0;                      // seconds that it is open from then on
    std::shared_ptr<const Playback> playback;  // for move_to; none = nothing moves
};

// glTF 2.0 (.gltf, .glb), PLY, X3D (.x3d), through assimp .obj and .stl, or .tessera, which is taken as it
// was saved (names, attachments, shared transforms; only a camera is added). Of the others: a scene without
// any light gets a soft sky (surfaces that glow only faintly are none), one without a camera gets one. A bad
// mesh or texture becomes a placeholder and a notice. Photometric units of KHR_lights_punctual are taken one
// to one as radiometric ones (1 cd = 1 W/sr, 1 lx = 1 W/m2), as most renderers do. NotFound: no such file.
// InvalidInput: damaged, another format, an unknown required extension, or nothing to draw; the message names
// file, object and remedy. Opens only files inside the scene's own folder, and the environment. Any thread;
// reads, decodes and allocates on the caller's.
Expected<ImportedScene> import_scene(const std::filesystem::path& file, const ImportOptions& options = {});

// The edit that brings the scene in. Root is created, or updated (name aside) where the scene already has
// one.
enum class RootEntry { Create, Update };
std::vector<scene::Entry> entries(const ImportedScene& scene, RootEntry root);

// What leads a scene from one time to another: updates of what moved, and the blobs that are new.
struct TimeStep {
    std::vector<scene::Entry> entries;
    std::vector<scene::BlobPtr> blobs;
};

// Brings the scene, its blobs and its cameras to a time; the scene then is what import_scene makes of the
// same file at that time, but for its notices and counts. Only for a scene that was imported as a Sequence;
// one in which nothing moves stays as it is. InvalidInput names what cannot be posed; the scene is then as
// before.
Expected<TimeStep> move_to(ImportedScene& scene, double seconds);

}  // namespace tessera::import
