#include "client/import/gltf_meshes.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <glm/common.hpp>
#include <numeric>

#include "client/import/closed_mesh.h"
#include "client/import/gltf_draco.h"
#include "client/import/gltf_text.h"
#include "client/import/limits.h"
#include "client/import/line_tubes.h"
#include "client/import/tangents.h"

namespace tessera::import {
namespace {

constexpr const char* Draco = "KHR_draco_mesh_compression";

std::map<std::string, int> draco_attributes(const tinygltf::Value& extension) {
    std::map<std::string, int> ids;
    if (!extension.Has("attributes")) return ids;
    const tinygltf::Value& attributes = extension.Get("attributes");
    for (const std::string& name : attributes.Keys()) ids[name] = index_member(attributes, name.c_str());
    return ids;
}

bool draws_triangles(int mode) {
    return mode == TINYGLTF_MODE_TRIANGLES || mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
           mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

bool draws_points_or_lines(int mode) {
    return mode >= TINYGLTF_MODE_POINTS && mode <= TINYGLTF_MODE_LINE_STRIP;
}

// glTF 2.0, 3.7.2.1: colour components must be clamped. NaN is kept and reported later.
bool clamp_colors(std::vector<glm::vec4>& colors) {
    bool clamped = false;
    for (glm::vec4& color : colors) {
        const glm::vec4 clamped_color = glm::clamp(color, 0.0f, 1.0f);
        for (int k = 0; k < 4; ++k) clamped |= clamped_color[k] < color[k] || clamped_color[k] > color[k];
        color = clamped_color;
    }
    return clamped;
}

}  // namespace

const std::vector<ObjectId>& GltfMeshes::geometries(int index) {
    const auto [entry, is_new] = geometries_.try_emplace(index);
    if (is_new) {
        const bool exists = index >= 0 && static_cast<std::size_t>(index) < model_.meshes.size();
        MeshPose own;  // with the default weights of the mesh
        if (exists) own.weights = model_.meshes[static_cast<std::size_t>(index)].weights;
        const bool deformable =
            std::any_of(own.weights.begin(), own.weights.end(), [](double w) { return w != 0.0; });
        entry->second = make_all(index, deformable ? &own : nullptr, nullptr);
    }
    return entry->second;
}

std::vector<ObjectId> GltfMeshes::deformed_geometries(int index, const MeshPose& pose,
                                                      std::vector<DeformedGeometry>& deformed) {
    return make_all(index, &pose, &deformed);
}

std::vector<ObjectId> GltfMeshes::make_all(int index, const MeshPose* pose,
                                           std::vector<DeformedGeometry>* deformed) {
    std::vector<ObjectId> geometries;
    if (index < 0 || static_cast<std::size_t>(index) >= model_.meshes.size()) {
        builder_.notice("mesh " + std::to_string(index) + " is missing: a magenta box replaces it");
        geometries.push_back(builder_.placeholder_geometry());
        return geometries;
    }
    const tinygltf::Mesh& mesh = model_.meshes[static_cast<std::size_t>(index)];
    const std::string name = mesh.name.empty() ? "mesh " + std::to_string(index) : mesh.name;
    if (mesh.primitives.empty()) builder_.notice("mesh '" + name + "' has no list of primitives");
    std::string first_cause;
    std::size_t bad = 0;
    for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
        const tinygltf::Primitive& primitive = mesh.primitives[i];
        if (draws_points_or_lines(primitive.mode))
            builder_.notice("mesh '" + name + "': its points and lines are drawn as octahedra and tubes");
        const std::string part = i == 0 ? name : name + " part " + std::to_string(i);
        try {
            geometries.push_back(make(primitive, name, part, pose, deformed));
        } catch (const Error& error) {
            if (error.code() != ErrorCode::InvalidInput) throw;
            if (bad++ == 0) first_cause = "primitive " + std::to_string(i) + ": " + error.what();
        }
    }
    if (bad > 0) {
        builder_.notice("mesh '" + name + "' is invalid (" + first_cause + (bad > 1 ? "; and others" : "") +
                        "): a magenta box replaces it; export the mesh again");
        geometries.push_back(builder_.placeholder_geometry());
    }
    check_volumes(geometries, name);
    return geometries;
}

// Light that enters an open mesh would never leave its medium.
void GltfMeshes::check_volumes(const std::vector<ObjectId>& geometries, const std::string& mesh_name) {
    constexpr double MostOpen =
        1e-3;  // holes with less than this fraction of the surface are modelling errors
    std::vector<MeshPart> parts;
    for (const ObjectId id : geometries) {
        const auto& geometry = builder_.get<scene::Geometry>(id);
        parts.push_back({builder_.stored(geometry.positions).as<glm::vec3>(),
                         builder_.stored(geometry.indices).as<std::uint32_t>()});
    }
    for (std::size_t i = 0; i < geometries.size(); ++i) {
        const ObjectId material = builder_.get<scene::Geometry>(geometries[i]).material;
        if (!materials_.has_volume(material) || open_fraction(parts, i) <= MostOpen) continue;
        const ObjectId thin = materials_.thin_walled(material);
        builder_.get<scene::Geometry>(geometries[i]).material = thin;
        builder_.notice("mesh '" + mesh_name +
                        "' is open, but its material has KHR_materials_volume, which is "
                        "for closed meshes: it is rendered thin-walled; close the mesh to make it solid");
    }
}

GltfMeshes::Source GltfMeshes::read(const tinygltf::Primitive& primitive, const std::string& mesh_name) {
    const auto& attributes = primitive.attributes;
    if (!draws_triangles(primitive.mode) && !draws_points_or_lines(primitive.mode)) {
        throw Error(ErrorCode::InvalidInput, "its mode " + std::to_string(primitive.mode) + " is unknown");
    }
    if (!attributes.contains("POSITION")) throw Error(ErrorCode::InvalidInput, "it has no positions");

    Source source;
    source.medium = materials_.medium(primitive.extras);
    // A primitive with a medium and no material has no surface; others get glTF's default material.
    if (primitive.material >= 0 || !source.medium) source.material = materials_.material(primitive.material);
    if (source.material.needs_tex_coords_1 && !attributes.contains("TEXCOORD_1")) {
        builder_.notice("mesh '" + mesh_name + "': it lacks the texture coordinates TEXCOORD_1");
        source.material.needs_tex_coords_1 = false;
    }
    MeshData& mesh = source.mesh;
    if (const auto draco = primitive.extensions.find(Draco); draco != primitive.extensions.end()) {
        const auto indices = attributes.find(IndicesAttribute);
        const bool counted = primitive.mode == TINYGLTF_MODE_TRIANGLES && indices != attributes.end();
        DracoMesh decoded = decode_draco(accessors_.view(index_member(draco->second, "bufferView")),
                                         draco_attributes(draco->second),
                                         counted ? accessors_.count(indices->second) / 3 : MaxDracoFaces);
        mesh = std::move(decoded.mesh);
        source.sets = std::move(decoded.sets);
        for (const JointSet& set : source.sets)
            builder_.spend(set.joints.size() * (sizeof(glm::u16vec4) + sizeof(glm::vec4)));
        if (!source.material.needs_tex_coords_1) mesh.tex_coords_1.clear();
        return source;
    }
    mesh.positions = accessors_.vec3(attributes.at("POSITION"));
    if (attributes.contains("NORMAL")) mesh.normals = accessors_.vec3(attributes.at("NORMAL"));
    if (attributes.contains("TANGENT")) mesh.tangents = accessors_.vec4(attributes.at("TANGENT"));
    if (attributes.contains("COLOR_0")) mesh.colors = accessors_.color(attributes.at("COLOR_0"));
    if (attributes.contains("TEXCOORD_0")) mesh.tex_coords = accessors_.vec2(attributes.at("TEXCOORD_0"));
    if (source.material.needs_tex_coords_1) mesh.tex_coords_1 = accessors_.vec2(attributes.at("TEXCOORD_1"));

    if (const auto indices = attributes.find(IndicesAttribute); indices != attributes.end()) {
        mesh.indices = accessors_.indices(indices->second);
    } else {
        mesh.indices.resize(mesh.positions.size());
        std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
    }
    if (primitive.mode == TINYGLTF_MODE_LINE) mesh.indices = segments_of_pairs(mesh.indices);
    if (primitive.mode == TINYGLTF_MODE_LINE_STRIP) mesh.indices = segments_of_strip(mesh.indices);
    if (primitive.mode == TINYGLTF_MODE_LINE_LOOP) mesh.indices = segments_of_loop(mesh.indices);
    if (primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP) mesh.indices = triangles_of_strip(mesh.indices);
    if (primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN) mesh.indices = triangles_of_fan(mesh.indices);
    return source;
}

ObjectId GltfMeshes::make(const tinygltf::Primitive& primitive, const std::string& mesh_name,
                          const std::string& name, const MeshPose* pose,
                          std::vector<DeformedGeometry>* deformed) {
    Source source = read(primitive, mesh_name);
    MeshData& mesh = source.mesh;
    DeformableMesh deformable;
    if (pose != nullptr) {
        deformable = read_deformation(primitive, mesh.positions.size(),
                                      pose->joints.empty() ? Joints::Ignored : Joints::Used,
                                      std::move(source.sets), accessors_, builder_);
        if (deformable.joint_count > pose->joints.size()) {
            throw Error(ErrorCode::InvalidInput,
                        "a vertex follows joint " + std::to_string(deformable.joint_count - 1) +
                            " of a skin that has " + std::to_string(pose->joints.size()));
        }
        mesh.origins.resize(mesh.positions.size());
        std::iota(mesh.origins.begin(), mesh.origins.end(), 0u);
    }
    if (draws_points_or_lines(primitive.mode))
        mesh = primitive.mode == TINYGLTF_MODE_POINTS ? point_octahedra(mesh) : line_tubes(mesh);
    if (clamp_colors(mesh.colors))
        builder_.notice("mesh '" + name + "': vertex colours outside 0 to 1 are clamped, as glTF specifies");
    for (const std::string& repair : check_and_repair(mesh))
        builder_.notice("mesh '" + name + "': " + repair);
    if (mesh.normals.empty()) mesh.tangents.clear();  // glTF 3.7.2.1: given tangents belong to given normals
    const auto& along = source.material.tangent_set == 0 ? mesh.tex_coords : mesh.tex_coords_1;
    if (source.material.needs_tangents && mesh.tangents.empty() && !along.empty()) {
        deformable.is_flat = mesh.normals.empty();
        if (deformable.is_flat) make_flat(mesh);
        generate_tangents(mesh, source.material.tangent_set);
    }
    const auto add = [&](const MeshData& finished) {
        const ObjectId id = builder_.add_geometry(name, source.material.id, finished);
        builder_.get<scene::Geometry>(id).medium = source.medium;
        return id;
    };
    if (pose == nullptr) return add(mesh);
    remap_vertices(deformable, mesh.origins);
    mesh.origins.clear();
    deformable.rest = std::move(mesh);
    const ObjectId id = add(deform(deformable, pose->weights, pose->joints));
    if (deformed != nullptr)
        deformed->push_back({id, name, std::make_shared<const DeformableMesh>(std::move(deformable))});
    return id;
}

}  // namespace tessera::import
