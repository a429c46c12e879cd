#include "client/import/gltf_placement.h"

#include <tiny_gltf.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

namespace tessera::import {
namespace {

constexpr double MaxCoordinate = 1e18;  // metres; its square still fits a float

bool usable(const glm::dmat4& matrix) {
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            if (!(std::abs(matrix[column][row]) <= MaxCoordinate)) return false;
        }
    }
    return true;
}

tl::unexpected<Error> invalid(const char* cause) {
    return failure(ErrorCode::InvalidInput, cause);
}

}  // namespace

Expected<glm::dmat4> placement(const glm::dvec3& translation, const glm::dvec4& rotation,
                               const glm::dvec3& scale) {
    const double length = glm::length(rotation);
    if (!(length > 1e-9) || !std::isfinite(length)) return invalid("its rotation is not a valid quaternion");
    const glm::dquat quaternion(rotation.w / length, rotation.x / length, rotation.y / length,
                                rotation.z / length);
    const glm::dmat4 matrix = glm::translate(glm::dmat4(1.0), translation) * glm::mat4_cast(quaternion) *
                              glm::scale(glm::dmat4(1.0), scale);
    if (!usable(matrix)) return invalid("its transform is not finite or beyond 1e18");
    return matrix;
}

Expected<glm::dmat4> node_matrix(const tinygltf::Node& node) {
    if (!node.matrix.empty()) {
        if (node.matrix.size() != 16) return invalid("its matrix does not have 16 numbers");
        glm::dmat4 matrix;
        for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
        if (!usable(matrix)) return invalid("its matrix is not finite or beyond 1e18");
        if (glm::dvec4(matrix[0][3], matrix[1][3], matrix[2][3], matrix[3][3]) !=
            glm::dvec4(0.0, 0.0, 0.0, 1.0)) {
            return invalid("its matrix is not affine");
        }
        return matrix;
    }
    const auto wrong = [](const std::vector<double>& values, std::size_t size) {
        return !values.empty() && values.size() != size;
    };
    if (wrong(node.translation, 3) || wrong(node.rotation, 4) || wrong(node.scale, 3)) {
        return invalid("its translation, rotation or scale has the wrong length");
    }
    const auto vector = [](const std::vector<double>& values, double otherwise) {
        return values.empty() ? glm::dvec3(otherwise) : glm::dvec3(values[0], values[1], values[2]);
    };
    const auto& r = node.rotation;
    return placement(vector(node.translation, 0.0),
                     r.empty() ? glm::dvec4(0.0, 0.0, 0.0, 1.0) : glm::dvec4(r[0], r[1], r[2], r[3]),
                     vector(node.scale, 1.0));
}

Expected<std::uint32_t> node_layers(const tinygltf::Node& node) {
    constexpr const char* Name = "tessera_layers";
    if (!node.extras.IsObject() || !node.extras.Has(Name)) return 0u;
    const tinygltf::Value& value = node.extras.Get(Name);
    // The parser stores integers as int; those from 2^31 on become negative.
    if (value.IsInt()) return static_cast<std::uint32_t>(value.GetNumberAsInt());
    const double number = value.IsNumber() ? value.GetNumberAsDouble() : -1.0;
    if (!(number >= 0.0 && number < 4294967296.0) || number != std::floor(number)) {
        return invalid("its tessera_layers are not an integer from 0 to 4294967295");
    }
    return static_cast<std::uint32_t>(number);
}

Expected<scene::Light> punctual_light(const tinygltf::Light& source) {
    scene::Light light;
    light.name = source.name;
    if (source.type == "point") {
        light.kind = scene::LightKind::Point;
    } else if (source.type == "spot") {
        light.kind = scene::LightKind::Spot;
    } else if (source.type == "directional") {
        light.kind = scene::LightKind::Directional;
    } else {
        return invalid("its type is none of point, spot and directional");
    }
    for (int i = 0; i < 3; ++i) {
        const double color = source.color.size() == 3 ? source.color[static_cast<std::size_t>(i)] : 1.0;
        const double intensity = color * source.intensity;
        if (!(intensity >= 0.0) || intensity > 1e18)
            return invalid("its intensity is negative or not finite");
        light.intensity[i] = static_cast<float>(intensity);
    }
    if (light.kind == scene::LightKind::Spot) {
        const double inner = source.spot.innerConeAngle, outer = source.spot.outerConeAngle;
        if (!(inner >= 0.0 && inner <= outer && outer > 0.0 && outer <= std::numbers::pi / 2 + 1e-6)) {
            return invalid("its cone angles are not 0 <= inner <= outer <= pi / 2");
        }
        light.inner_cone_angle = static_cast<float>(inner);
        light.outer_cone_angle = static_cast<float>(outer);
    }
    return light;
}

Expected<scene::Camera> camera_of(const tinygltf::Camera& source) {
    scene::Camera camera;
    camera.name = source.name;
    if (source.type == "orthographic") {
        const double width = source.orthographic.xmag, height = source.orthographic.ymag;
        if (!(height > 0.0 && height < 1e12)) return invalid("its ymag is not above 0 and below 1e12");
        if (!(width > 0.0 && width < 1e6 * height)) return invalid("its xmag is out of range");
        camera.projection = scene::Projection::Orthographic;
        camera.orthographic_height = 2.0 * height;
        camera.aspect_ratio = width / height;
        return camera;
    }
    if (source.type != "perspective") return invalid("its type is neither perspective nor orthographic");
    const double fov = source.perspective.yfov, aspect = source.perspective.aspectRatio;
    if (!(fov > 0.0 && fov < std::numbers::pi)) return invalid("its field of view is not between 0 and pi");
    if (!(aspect >= 0.0 && aspect < 1e6)) return invalid("its aspect ratio is out of range");
    camera.vertical_fov = fov;
    camera.aspect_ratio = aspect;
    return camera;
}

}  // namespace tessera::import
