#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <algorithm>
#include <array>
#include <new>

#include "client/export/export.h"
#include "client/import/assimp_import.h"
#include "client/import/draco_decoder.h"
#include "client/import/import.h"
#include "client/import/limits.h"
#include "client/import/post_process.h"
#include "client/import/scene_transfer.h"
#include "mediator/scene/validate.h"
#include "tests/fuzz/decoders/decoder.h"

// Scene files. What is imported is a valid scene.
namespace tessera::fuzz {

namespace {

scene::Scene scene_of(const import::ImportedScene& imported) {
    scene::Scene scene;
    const auto applied = scene.apply_entries(import::entries(imported, import::RootEntry::Create));
    require(applied.has_value(), "an imported scene cannot be applied");
    return scene;
}

void require_valid(const import::ImportedScene& imported) {
    const scene::Scene scene = scene_of(imported);
    const auto require_none = [](const std::vector<scene::Problem>& problems) {
        require(problems.empty(),
                problems.empty() ? "" : "an imported scene is invalid: " + problems[0].message);
    };
    require_none(scene::validate(scene));
    scene::BlobStore blobs;
    for (const scene::BlobPtr& blob : imported.blobs) blobs.insert(blob);
    for (const auto& [id, object] : scene.objects()) require_none(scene::validate_blobs(id, *object, blobs));
}

void import_file(const std::filesystem::path& file) {
    auto imported = import::import_scene(file, {.at = 0.25, .motion = import::Motion::Sequence});
    if (!imported) return require_reason(imported.error());
    require_valid(*imported);
    if (!imported->playback) return;
    const auto moved = import::move_to(*imported, 1.0);
    if (!moved) return require_reason(moved.error());
    require_valid(*imported);
}

void gltf(Bytes bytes) {
    import_file(file_of(text_of(bytes).starts_with("glTF") ? "scene.glb" : "scene.gltf", bytes));
}

void ply(Bytes bytes) {
    import_file(file_of("scene.ply", bytes));
}

void x3d(Bytes bytes) {
    import_file(file_of("scene.x3d", bytes));
}

// The file without its checksum, which is added.
void tessera_file(Bytes bytes) {
    std::vector<std::byte> file(bytes.begin(), bytes.end());
    const Hash256 hash = blake2b(bytes);
    const auto checksum = std::as_bytes(std::span(hash.bytes));
    file.insert(file.end(), checksum.begin(), checksum.end());
    import_file(file_of("scene.tessera", file));
}

constexpr std::string_view SampleScene =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property float u\nproperty float v\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 0 0 255 0 0\n1 0 0 1 0 0 255 0\n1 1 0 1 1 0 0 255\n0 1 0 0 1 9 9 9\n4 0 1 2 3\n";

import::ImportedScene sample_scene(){
    auto imported = import::import_scene(file_of("sample.ply", bytes_of(SampleScene)));
require(imported.has_value(), "the sample scene cannot be imported");
return std::move(*imported);
}

std::vector<std::byte> exported(const std::string& name) {
    const import::ImportedScene imported = sample_scene();
    scene::BlobStore blobs;
    for (const scene::BlobPtr& blob : imported.blobs) blobs.insert(blob);
    const std::filesystem::path path = file_of(name, {});
    require(exporting::write_scene(scene_of(imported), blobs, path).has_value(), "a scene cannot be saved");
    return content_of(path);
}

Seeds tessera_file_seeds() {
    std::vector<std::byte> file = exported("new.tessera");
    file.resize(file.size() - sizeof(Hash256::bytes));
    return {file};
}

Seeds gltf_seeds() {
    return {exported("new.glb")};
}

Seeds ply_seeds() {
    return {bytes_of(SampleScene)};
}

void draco_mesh(Bytes bytes) {
    accepts([&] {
        const std::span<const unsigned char> data(reinterpret_cast<const unsigned char*>(bytes.data()),
                                                  bytes.size());
        const auto mesh = import::decode_draco_mesh(data, import::MaxDracoFaces);
        require(mesh != nullptr, "there is no mesh and no error");
        for (draco::FaceIndex face(0); face < mesh->num_faces(); ++face) {
            for (const draco::PointIndex point : mesh->face(face))
                require(point < mesh->num_points(), "a triangle has a corner that does not exist");
        }
    });
}

// Two triangles, by both methods.
Seeds draco_mesh_seeds() {
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(2);
    const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    const std::array<std::array<float, 9>, 2> corners{
        {{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 0, 1, 0, 0, 1, 1, 0}}};
    for (std::uint32_t i = 0; i < 2; ++i) {
        const float* at = corners[i].data();
        builder.SetAttributeValuesForFace(position, draco::FaceIndex(i), at, at + 3, at + 6);
    }
    const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
    Seeds seeds;
    for (const auto method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING}) {
        draco::Encoder encoder;
        encoder.SetEncodingMethod(method);
        encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 11);
        draco::EncoderBuffer buffer;
        require(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok(), "a mesh cannot be compressed");
        seeds.push_back(bytes_of({buffer.data(), buffer.size()}));
    }
    return seeds;
}

// In this process, where a crash is seen, and so is what our code makes of the result.
void with_assimp(const char* name, Bytes bytes) {
    const import::ImportOptions options;
    import::SceneBuilder builder(options);
    accepts([&] {
        try {
            import::read_with_assimp(file_of(name, bytes), builder);
        } catch (const std::bad_alloc&) {
            return;  // assimp believes what a file claims: the child process has a limit of memory
        }
        import::post_process(builder);
        require_valid(builder.result());
    });
}

void obj(Bytes bytes) {
    with_assimp("scene.obj", bytes);
}

void stl(Bytes bytes) {
    with_assimp("scene.stl", bytes);
}

// What the process that reads .obj and .stl with assimp sends to this one.
void transferred_scene(Bytes bytes) {
    const import::ImportOptions options;
    import::SceneBuilder builder(options);
    accepts(
        [&] {
        import::receive_scene(
            [&](std::span<std::byte> part) {
                if (part.size() > bytes.size()) throw Error(ErrorCode::InvalidInput, "it ends too early");
        std::copy_n(bytes.begin(), part.size(), part.begin());
        bytes = bytes.subspan(part.size());
        },
        builder);
    scene::Scene scene;
    const auto entries = import::entries(builder.result(), import::RootEntry::Create);
    require(scene.apply_entries(entries).has_value(), "a received scene cannot be applied");
});
}

Seeds transferred_scene_seeds() {
    std::vector<std::byte> sent;
    import::ImportedScene scene = sample_scene();
    scene.notices = {"a notice"};
    import::send_scene(scene, [&](std::span<const std::byte> part) {
        sent.insert(sent.end(), part.begin(), part.end());
});
return {sent};
}

}  // namespace

std::vector<Decoder> scene_decoders() {
    return {{"gltf", gltf, gltf_seeds},
            {"draco", draco_mesh, draco_mesh_seeds},
            {"obj", obj},
            {"stl", stl},
            {"ply", ply, ply_seeds},
            {"x3d", x3d},
            {"tessera", tessera_file, tessera_file_seeds},
            {"transfer", transferred_scene, transferred_scene_seeds}};
}

}  // namespace tessera::fuzz
