#include "client/import/gltf_draco.h"

#include <draco/mesh/mesh.h>

#include "client/import/draco_decoder.h"
#include "mediator/base/error.h"

namespace tessera::import {
namespace {

[[noreturn]] void reject_draco(const std::string& cause) {
    throw Error(ErrorCode::InvalidInput, "its Draco data " + cause);
}

template <class Number, class Vector>
std::vector<Vector> converted(const draco::Mesh& mesh, const std::map<std::string, int>& ids,
                              const std::string& name) {
    const auto found = ids.find(name);
    if (found == ids.end()) return {};
    if (found->second < 0) reject_draco("has no attribute " + name);
    const draco::PointAttribute* attribute =
        mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(found->second));
    if (!attribute) reject_draco("has no attribute " + name);
    const int given = attribute->num_components();
    if (given != Vector::length() && !(given == 3 && Vector::length() == 4)) {
        reject_draco("has " + std::to_string(given) + " components in " + name);
    }
    std::vector<Vector> values(mesh.num_points(), Vector(1));  // alpha of a colour without one
    for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
        const draco::AttributeValueIndex index = attribute->mapped_index(draco::PointIndex(i));
        if (index.value() >= attribute->size() ||
            !attribute->ConvertValue<Number>(index, static_cast<std::int8_t>(given), &values[i][0])) {
            reject_draco("lacks a value of " + name);
        }
    }
    return values;
}

template <class Vector>
std::vector<Vector> values_of(const draco::Mesh& mesh, const std::map<std::string, int>& ids,
                              const std::string& name) {
    return converted<float, Vector>(mesh, ids, name);
}

std::vector<JointSet> joint_sets(const draco::Mesh& mesh, const std::map<std::string, int>& ids) {
    std::vector<JointSet> sets;
    for (std::size_t i = 0; ids.contains("JOINTS_" + std::to_string(i)); ++i) {
        const std::string number = std::to_string(i);
        if (!ids.contains("WEIGHTS_" + number)) reject_draco("lacks WEIGHTS_" + number);
        sets.push_back({converted<std::uint16_t, glm::u16vec4>(mesh, ids, "JOINTS_" + number),
                        values_of<glm::vec4>(mesh, ids, "WEIGHTS_" + number)});
    }
    return sets;
}

}  // namespace

DracoMesh decode_draco(std::span<const unsigned char> bytes, const std::map<std::string, int>& attribute_ids,
                       std::uint64_t most_faces) {
    const std::unique_ptr<draco::Mesh> mesh = decode_draco_mesh(bytes, most_faces);

    DracoMesh decoded_mesh;
    MeshData& result = decoded_mesh.mesh;
    result.indices.reserve(std::size_t{mesh->num_faces()} * 3);
    for (std::uint32_t i = 0; i < mesh->num_faces(); ++i) {
        const draco::Mesh::Face& face = mesh->face(draco::FaceIndex(i));
        for (int k = 0; k < 3; ++k) result.indices.push_back(face[static_cast<std::size_t>(k)].value());
    }
    result.positions = values_of<glm::vec3>(*mesh, attribute_ids, "POSITION");
    result.normals = values_of<glm::vec3>(*mesh, attribute_ids, "NORMAL");
    result.tangents = values_of<glm::vec4>(*mesh, attribute_ids, "TANGENT");
    result.tex_coords = values_of<glm::vec2>(*mesh, attribute_ids, "TEXCOORD_0");
    result.tex_coords_1 = values_of<glm::vec2>(*mesh, attribute_ids, "TEXCOORD_1");
    result.colors = values_of<glm::vec4>(*mesh, attribute_ids, "COLOR_0");
    decoded_mesh.sets = joint_sets(*mesh, attribute_ids);
    return decoded_mesh;
}

}  // namespace tessera::import
