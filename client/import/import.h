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

// Whether to add a camera to a file without one and a default environment to a file without light. Leave is
// for imports into an existing scene.
enum class Missing { Add, Leave };

// Sequence: the scene will be moved to other times with move_to.
enum class Motion { Still, Sequence };
// How transmissive glTF materials without KHR_materials_volume are rendered: thin-walled, as specified, or as
// solid, refracting glass, as most programs that write such files do.
enum class Glass { Thin, Solid };

// What one unit of radiance is where a file has lights in candela and lux (KHR_lights_punctual). Physical: one candela per
// square metre, as of emissive surfaces. Blender: one watt; its exporter writes 683 lumens for each watt of a lamp or sun.
enum class LightUnits { Physical, Blender };
inline constexpr float LumensPerWatt = 683.0f;

struct ImportOptions {
    ObjectId first_id{2};                 // ids of objects are consecutive from here
    ObjectId end_id{1ull << 32};          // one past the last id that may be used
    std::optional<glm::vec3> background;  // linear radiance; counts as light when not black
    std::filesystem::path environment;    // latitude-longitude .exr or .hdr; empty = none
    float environment_strength = 1.0f;
    float environment_rotation = 0.0f;  // radians, as Background::rotation
    Missing missing = Missing::Add;
    std::optional<double> at;  // seconds into the animations; none = the rest pose
    double shutter = 0.0;      // seconds from `at`; animated objects get motion keys over it
    std::string animation;     // play only this one, by name, else by index; "" = all
    Motion motion = Motion::Still;
    Glass glass = Glass::Thin;
    LightUnits light_units = LightUnits::Physical;
    // Lights to leave out for speed, the sky being raised by their irradiance: these, by name, and those of a glTF file
    // with the extras {"hard_shadow": false}.
    std::vector<std::string> lights_as_sky;
    bool soft_lights_as_sky = false;
    // Width / height of the picture for which a missing camera is framed; wider pictures show everything,
    // too.
    double aspect_ratio = 1.0;
};

// A camera with its world pose; the Camera object is also in the scene.
struct CameraInfo {
    std::string name;                   // unique
    glm::dmat4 world_from_camera{1.0};  // rigid; looks along -z, y up
    scene::Camera camera;               // a copy of the object
    std::vector<glm::dmat4> motion;     // world_from_camera at motion keys, as scene::Transform::motion
};

struct AnimationInfo {
    std::string name;
    double seconds = 0.0;  // time of its last key
};

struct ImportCounts {
    std::uint64_t triangles = 0;             // of all geometries, not counting instances
    std::uint64_t degenerate_triangles = 0;  // of these, without area; kept
    std::uint64_t geometries = 0;
    std::uint64_t instances = 0;  // of geometries
    std::uint64_t lights = 0;     // instances of point, spot and directional lights
    std::uint64_t emissive_geometries = 0;
    std::uint64_t textures = 0;
    std::uint64_t placeholders = 0;  // invalid meshes and textures, shown in magenta
};

// An imported scene, independent of the file. Deterministic: the same file and options give the same ids and
// bytes.
struct ImportedScene {
    scene::Root root;                    // children and background; its id is scene::RootId
    std::vector<scene::Create> objects;  // all others, ids ascending and consecutive from first_id
    std::vector<scene::BlobPtr> blobs;   // all that the objects refer to, each once
    std::vector<CameraInfo> cameras;     // of the file in file order, else the one that was added
    std::vector<std::string> notices;    // about what was added, replaced or ignored; each once
    ImportCounts counts;
    std::vector<AnimationInfo> animations;  // all of the file
    std::vector<std::string> extensions;    // extensionsUsed of glTF; unsupported ones give a notice
    std::vector<std::string> variants;  // names of KHR_materials_variants; the default materials are imported
    // Geometries removed from the children of a transform while it is degenerate.
    std::map<ObjectId, std::vector<ObjectId>> without_volume;
    std::optional<double> seconds;             // its time; none = the rest pose
    double shutter = 0.0;                      // seconds that it is open from that time
    std::shared_ptr<const Playback> playback;  // for move_to; null = nothing is animated
};

// Imports glTF 2.0 (.gltf, .glb), PLY, X3D (.x3d), .obj and .stl (with assimp), or .tessera, which is loaded
// as it was saved (names, attachments, shared transforms; only a missing camera is added). In other formats,
// a scene without light (faint emission does not count) gets a default environment, and one without camera
// gets a framing camera. An invalid mesh or texture becomes a placeholder with a notice. Photometric units of
// KHR_lights_punctual are used as radiometric ones (1 cd = 1 W/sr, 1 lx = 1 W/m2), as in most renderers.
// NotFound: no such file. InvalidInput: damaged, unsupported format or required extension, or nothing to
// render; the message names file, object and remedy. Opens only the environment and files inside the scene's
// folder. Any thread; all work is done on the calling thread.
Expected<ImportedScene> import_scene(const std::filesystem::path& file, const ImportOptions& options = {});

// The edit that adds the imported objects to a scene. The root is created, or updated except for its name if
// it exists.
enum class RootEntry { Create, Update };
std::vector<scene::Entry> entries(const ImportedScene& scene, RootEntry root);

// The change from one time to another: updates of animated objects, and new blobs.
struct SceneUpdate {
    std::vector<scene::Entry> entries;
    std::vector<scene::BlobPtr> blobs;
};

// Moves the scene, its blobs and its cameras to a time. The result equals an import of the same file at that
// time, except for notices and counts. Only for scenes imported as Sequence; a scene without animation is
// unchanged. InvalidInput names what cannot be posed; the scene is then unchanged.
Expected<SceneUpdate> move_to(ImportedScene& scene, double seconds);

}  // namespace tessera::import
