#include "client/import/scene_builder.h"

#include <array>
#include <cstring>

#include "client/import/limits.h"

namespace tessera::import {
namespace {

// Names of kinds for users, independent of those on the wire.
constexpr std::array<const char*, std::variant_size_v<scene::Object>> KindNames{
    "root",   "node",       "mesh",       "material",       "texture", "light",
    "camera", "background", "attachment", "surface shader", "medium"};

MeshData unit_box() {
    MeshData box;
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-0.5f, 0.5f}) {
            const auto first = static_cast<std::uint32_t>(box.positions.size());
            for (int corner = 0; corner < 4; ++corner) {
                glm::vec3 position(0.0f), normal(0.0f);
                position[axis] = side;
                position[(axis + 1) % 3] = corner == 1 || corner == 2 ? 0.5f : -0.5f;
                position[(axis + 2) % 3] = corner >= 2 ? 0.5f : -0.5f;
                normal[axis] = side < 0.0f ? -1.0f : 1.0f;
                box.positions.push_back(position);
                box.normals.push_back(normal);
            }
            const std::uint32_t odd = side < 0.0f ? 1 : 0;  // counter-clockwise seen from outside
            box.indices.insert(box.indices.end(), {first, first + 1 + odd, first + 2 - odd, first,
                                                   first + 2 + odd, first + 3 - odd});
        }
    }
    return box;
}

}  // namespace

std::string SceneBuilder::unique_name(scene::ObjectKind kind, const std::string& wanted) {
    const std::uint64_t number = added_[kind]++;
    const std::string base =
        wanted.empty() ? KindNames[static_cast<std::size_t>(kind)] + (" " + std::to_string(number)) : wanted;
    std::string name = base;
    std::uint64_t& suffix = last_suffix_[{kind, base}];
    if (suffix == 0) suffix = 1;
    while (!names_.emplace(kind, name).second) name = base + "." + std::to_string(++suffix);
    return name;
}

ObjectId SceneBuilder::add(scene::Object object) {
    const ObjectId id{options_.first_id.value + result_.objects.size()};
    if (id >= options_.end_id) {
        throw Error(ErrorCode::InvalidInput, "it needs more than the " +
                                                 std::to_string(result_.objects.size()) +
                                                 " objects that are allowed: split the scene");
    }
    const scene::ObjectKind kind = scene::kind(object);
    std::visit([&](auto& value) { value.name = unique_name(kind, value.name); }, object);
    result_.objects.push_back({id, std::move(object)});
    return id;
}

void SceneBuilder::adopt(ObjectId id, scene::Object object) {
    if (auto* root = std::get_if<scene::Root>(&object)) {
        result_.root = std::move(*root);
        return;
    }
    if (id.value != options_.first_id.value + result_.objects.size() || id >= options_.end_id)
        throw Error(ErrorCode::InvalidInput, "the ids of its objects have a gap: export it again");
    const scene::ObjectKind kind = scene::kind(object);
    ++added_[kind];
    std::visit([&](const auto& value) { names_.emplace(kind, value.name); }, object);
    if (const auto* geometry = std::get_if<scene::Geometry>(&object)) {
        Bounds& bounds = bounds_[id];
        const auto positions = stored(geometry->positions).as<glm::vec3>();
        for (const std::uint32_t index : stored(geometry->indices).as<std::uint32_t>())
            bounds.add(glm::dvec3(positions[index]));
    }
    result_.objects.push_back({id, std::move(object)});
}

scene::BlobRef SceneBuilder::blob(std::span<const std::byte> bytes) {
    if (bytes.empty()) return {};
    spend(bytes.size());
    auto blob_ptr = std::make_shared<const scene::Blob>(bytes);
    const auto [position, is_new] = blobs_.emplace(blob_ptr->hash(), blob_ptr);
    if (is_new) result_.blobs.push_back(std::move(blob_ptr));
    return scene::reference(*position->second);
}

void SceneBuilder::spend(std::uint64_t bytes) {
    decoded_bytes_ += bytes;
    if (decoded_bytes_ > MaxDecodedBytes) {
        throw Error(ErrorCode::OutOfMemory, "its arrays and textures decode to more than " +
                                                std::to_string(MaxDecodedBytes >> 30) +
                                                " GiB: split the scene");
    }
}

ObjectId SceneBuilder::add_geometry(std::string name, ObjectId material, const MeshData& mesh) {
    scene::Geometry geometry;
    geometry.name = std::move(name);
    geometry.material = material;
    geometry.indices = blob(mesh.indices);
    geometry.positions = blob(mesh.positions);
    geometry.normals = blob(mesh.normals);
    geometry.tangents = blob(mesh.tangents);
    geometry.tex_coords = blob(mesh.tex_coords);
    geometry.tex_coords_1 = blob(mesh.tex_coords_1);
    geometry.colors = blob(mesh.colors);
    result_.counts.triangles += mesh.indices.size() / 3;
    result_.counts.degenerate_triangles += count_degenerate(mesh);
    ++result_.counts.geometries;
    const ObjectId id = add(std::move(geometry));
    bounds_[id] = bounds_of(mesh);
    return id;
}

ObjectId SceneBuilder::placeholder_geometry() {
    if (!placeholder_geometry_) {
        scene::Material magenta;
        magenta.name = "placeholder";
        magenta.base_color = {1.0f, 0.0f, 1.0f, 1.0f};
        magenta.unlit = true;
        const ObjectId material = add(std::move(magenta));
        placeholder_geometry_ = add_geometry("placeholder", material, unit_box());
    }
    ++result_.counts.placeholders;
    return placeholder_geometry_;
}

ObjectId SceneBuilder::placeholder_texture() {
    if (!placeholder_texture_) {
        constexpr std::uint32_t Edge = 8;
        std::vector<std::uint8_t> texels;
        for (std::uint32_t i = 0; i < Edge * Edge; ++i) {
            const std::uint8_t level = (i + i / Edge) % 2 == 0 ? 255 : 0;
            texels.insert(texels.end(), {level, 0, level, 255});
        }
        scene::Texture checker;
        checker.name = "placeholder";
        checker.width = checker.height = Edge;
        checker.format = scene::TexelFormat::Rgba8Srgb;
        checker.filter = scene::TextureFilter::Nearest;
        checker.texels = blob(texels);
        placeholder_texture_ = add(std::move(checker));
    }
    ++result_.counts.placeholders;
    return placeholder_texture_;
}

void SceneBuilder::notice(const std::string& text) {
    if (notices_.insert(text).second) result_.notices.push_back(text);
}

}  // namespace tessera::import
