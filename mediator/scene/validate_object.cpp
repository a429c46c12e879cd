#include "mediator/scene/validate_object.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mediator/scene/fields.h"

namespace tessera::scene {

namespace {

constexpr std::size_t MaxName = 4096;
constexpr std::uint64_t MaxElements = std::uint64_t{1} << 31;
constexpr double MaxCoordinate = 1e15;  // beyond, double transforms lose the centimetre
constexpr double Pi = std::numbers::pi;
constexpr double Largest = std::numeric_limits<float>::max();

class Check {
  public:
    Check(ObjectId id, const Object& object) : id_(id), object_(object) {}
    void that(bool holds, const std::string& cause) {
        if (!holds) problems_.push_back(describe(id_, object_) + ": " + cause);
    }
    template <class V>
    void finite(const V& value, const std::string& what) {
        if constexpr (std::is_floating_point_v<V>) {
            that(std::isfinite(value), what + " is not a finite number");
        } else {
            for (glm::length_t i = 0; i < value.length(); ++i) {
                if (std::isfinite(value[i])) continue;
                return that(false, what + " is not a finite number");
            }
        }
    }
    template <class V>
    void not_negative(const V& value, const std::string& what) {
        for (glm::length_t i = 0; i < value.length(); ++i) {
            if (value[i] >= 0 && std::isfinite(value[i])) continue;
            return that(false, what + " is negative or not finite");
        }
    }
    // Shares of light.
    template <class V>
    void unit(const V& value, const std::string& what) {
        for (glm::length_t i = 0; i < value.length(); ++i) range(value[i], 0.0, 1.0, what);
    }
    void range(double value, double low, double high, const std::string& what) {
        that(value >= low && value <= high,
             what + " lies outside " + std::to_string(low) + " .. " + std::to_string(high));
    }
    template <class Enum>
    void known(Enum value, Enum last, const std::string& what) {
        that(static_cast<unsigned>(value) <= static_cast<unsigned>(last), what + " is unknown");
    }
    std::vector<std::string> take() { return std::move(problems_); }

  private:
    ObjectId id_;
    const Object& object_;
    std::vector<std::string> problems_;
};

void check(const Root& root, Check& check) {
    check.finite(root.render_origin, "the render origin");
    check.that(glm::all(glm::lessThan(glm::abs(root.render_origin), glm::dvec3(MaxCoordinate))),
               "the render origin is farther away than 1e15 m");
}

void check(const glm::dmat4& m, const std::string& what, Check& check) {
    for (glm::length_t column = 0; column < 4; ++column) check.finite(m[column], what);
    check.that(m[0][3] == 0.0 && m[1][3] == 0.0 && m[2][3] == 0.0 && m[3][3] == 1.0,
               what + " is not affine: its last row has to be 0 0 0 1");
    check.that(glm::all(glm::lessThan(glm::abs(glm::dvec3(m[3])), glm::dvec3(MaxCoordinate))),
               "the translation of " + what + " is longer than 1e15 m");
}

void check_steps(std::size_t count, const std::string& what, Check& check) {
    check.that(count <= MaxMotion, what + " has " + std::to_string(count) + " steps: there may be " +
                                       std::to_string(MaxMotion) + " after the first");
}

void check(const Transform& transform, Check& check) {
    check.known(transform.hint, MotionHint::Animated, "the motion hint");
    scene::check(transform.matrix, "the matrix", check);
    check_steps(transform.motion.size(), "the motion", check);
    for (std::size_t i = 0; i < transform.motion.size(); ++i) {
        scene::check(transform.motion[i], "the matrix of step " + std::to_string(i + 1) + " of the motion",
                     check);
    }
}

// Byte sizes that fit together; what is in the arrays is validate_blobs' matter.
void check(const Geometry& geometry, Check& check) {
    check.known(geometry.hint, MotionHint::Animated, "the motion hint");
    check.that(!geometry.positions.empty() && !geometry.indices.empty(),
               "it has no positions or no indices: a mesh needs both");
    check.that(geometry.indices.byte_size % 12 == 0, "the indices are no whole triangles");
    check.that(geometry.positions.byte_size % 12 == 0, "the positions are no whole vectors");
    const std::uint64_t vertices = geometry.positions.byte_size / 12;
    check.that(vertices <= MaxElements && geometry.indices.byte_size / 12 <= MaxElements,
               "it has more than 2^31 vertices or triangles: split it");
    const auto per_vertex = [&](const BlobRef& blob, std::uint64_t bytes, const std::string& what) {
        check.that(blob.empty() || (blob.byte_size == vertices * bytes),
                   "the " + what + " are " + std::to_string(blob.byte_size) + " bytes, not one per vertex (" +
                       std::to_string(vertices * bytes) + ")");
    };
    per_vertex(geometry.normals, 12, "normals");
    per_vertex(geometry.tangents, 16, "tangents");
    per_vertex(geometry.tex_coords, 8, "texture coordinates");
    per_vertex(geometry.colors, 16, "vertex colours");
    per_vertex(geometry.tex_coords_1, 8, "second texture coordinates");
    check_steps(geometry.motion_positions.size(), "the motion of its positions", check);
    for (const auto* steps : {&geometry.motion_positions, &geometry.motion_normals}) {
        for (const BlobRef& step : *steps) {
            check.that(!step.empty(), "a step of its motion is empty: each has an element for each vertex");
            per_vertex(step, 12, "elements of a step of its motion");
        }
    }
    check.that(
        geometry.motion_normals.empty() ||
            (geometry.motion_normals.size() == geometry.motion_positions.size() && !geometry.normals.empty()),
        "its normals move in " + std::to_string(geometry.motion_normals.size()) +
            " steps, its positions in " + std::to_string(geometry.motion_positions.size()) +
            ": they need as many steps, and normals to begin with");
}

// A field's name as people say it.
std::string in_words(std::string_view name) {
    std::string text(name);
    std::replace(text.begin(), text.end(), '_', ' ');
    return text;
}

void check(const TextureSlot& slot, const std::string& what, Check& check) {
    check.finite(slot.offset, what + "'s offset");
    check.finite(slot.scale, what + "'s scale");
    check.finite(slot.rotation, what + "'s rotation");
    check.that(slot.set <= 1,
               what + " uses texture coordinates " + std::to_string(slot.set) + ": there are sets 0 and 1");
}

void check(const Material& material, Check& check) {
    for (glm::length_t i = 0; i < 4; ++i) check.range(material.base_color[i], 0.0, 1.0, "the base colour");
    check.range(material.metallic, 0.0, 1.0, "metallic");
    check.range(material.roughness, 0.0, 1.0, "roughness");
    check.finite(material.normal_scale, "the normal scale");
    check.not_negative(material.emission, "the emission");
    check.known(material.alpha_mode, AlphaMode::Blend, "the alpha mode");
    check.range(material.alpha_cutoff, 0.0, Largest, "the alpha cutoff");
    check.that(material.index_of_refraction == 0.0f ||
                   (material.index_of_refraction >= 1.0f && material.index_of_refraction <= 100.0f),
               "the index of refraction is neither 0 nor between 1 and 100");
    check.range(material.transmission, 0.0, 1.0, "transmission");
    check.range(material.thickness, 0.0, Largest, "the thickness");
    check.unit(material.attenuation_color, "the attenuation colour");
    check.range(material.attenuation_distance, 0.0, Largest, "the attenuation distance");
    check.range(material.specular, 0.0, 1.0, "specular");
    check.not_negative(material.specular_color, "the specular colour");
    check.range(material.clearcoat, 0.0, 1.0, "clearcoat");
    check.range(material.clearcoat_roughness, 0.0, 1.0, "the clearcoat roughness");
    check.finite(material.clearcoat_normal_scale, "the clearcoat normal scale");
    check.unit(material.sheen_color, "the sheen colour");
    check.range(material.sheen_roughness, 0.0, 1.0, "the sheen roughness");
    check.range(material.anisotropy, 0.0, 1.0, "anisotropy");
    check.finite(material.anisotropy_rotation, "the anisotropy rotation");
    check.range(material.iridescence, 0.0, 1.0, "iridescence");
    check.range(material.iridescence_index_of_refraction, 1.0, 100.0, "the iridescence index of refraction");
    check.range(material.iridescence_thickness_minimum, 0.0, Largest, "the least iridescence thickness");
    check.range(material.iridescence_thickness_maximum, 0.0, Largest, "the greatest iridescence thickness");
}

void check(const SurfaceShader& shader, Check& check) {
    check.not_negative(shader.emission, "the emission");
    check.unit(shader.ambient, "ambient");
    check.unit(shader.diffuse, "diffuse");
    check.unit(shader.specular, "specular");
    for (glm::length_t i = 0; i < 2; ++i) check.range(shader.shininess[i], 0.0, 1e6, "shininess");
    check.range(shader.alpha, 0.0, 1.0, "alpha");
    check.known(shader.normal_format, NormalFormat::Snorm, "the normal format");
    check.known(shader.normal_space, NormalSpace::Object, "the normal space");
    check.finite(shader.normal_scale, "the normal scale");
    check.finite(shader.normal_bias, "the normal bias");
    check.finite(shader.height_scale, "the height scale");
    check.unit(shader.reflection, "reflection");
    check.unit(shader.transmission, "transmission");
    for (glm::length_t i = 0; i < 3; ++i) {
        check.range(shader.relative_index_of_refraction[i], 0.01, 100.0, "the relative index of refraction");
    }
    check.range(shader.fresnel_blend, 0.0, 1.0, "the Fresnel blend");
    check.range(shader.tangent_tex_coords, -1, 1, "the tangents' texture coordinates");
    check.range(shader.binormal_tex_coords, -1, 1, "the binormals' texture coordinates");
    check.not_negative(shader.environment, "the environment");
}

void check(const Medium& medium, Check& check) {
    check.not_negative(medium.emission, "the emission");
    check.not_negative(medium.absorption, "the absorption");
    check.not_negative(medium.scattering, "the scattering");
    check.range(medium.anisotropy, -1.0, 1.0, "the anisotropy");
}

void check(const Texture& texture, Check& check) {
    check.known(texture.format, TexelFormat::RgbFloat, "the texel format");
    check.known(texture.wrap_s, Wrap::Clamp, "the wrap mode");
    check.known(texture.wrap_t, Wrap::Clamp, "the wrap mode");
    check.known(texture.filter, TextureFilter::Nearest, "the filter");
    constexpr std::uint32_t MaxEdge = 65536;
    check.that(
        texture.width >= 1 && texture.height >= 1 && texture.width <= MaxEdge && texture.height <= MaxEdge,
        "its size is not between 1x1 and 65536x65536");
    check.that(texture.depth >= 1 && texture.depth <= MaxEdge, "its depth is not between 1 and 65536");
    const std::uint64_t texel = texture.format == TexelFormat::RgbFloat ? 12 : 4;
    check.that(
        texture.texels.byte_size == std::uint64_t{texture.width} * texture.height * texture.depth * texel,
        "its texels are " + std::to_string(texture.texels.byte_size) +
            " bytes, not width x height x depth x " + std::to_string(texel));
}

void check(const Light& light, Check& check) {
    check.known(light.kind, LightKind::Quad, "the kind of light");
    check.not_negative(light.intensity, "the intensity");
    check.range(light.inner_cone_angle, 0.0, Pi / 2 + 1e-6, "the inner cone angle");
    check.range(light.outer_cone_angle, 0.0, Pi / 2 + 1e-6, "the outer cone angle");
    check.that(light.kind != LightKind::Spot || light.inner_cone_angle <= light.outer_cone_angle,
               "the inner cone is wider than the outer");
    check.range(light.radius, 0.0, Largest, "the radius");
    for (glm::length_t i = 0; i < 2; ++i) check.range(light.size[i], 0.0, Largest, "the size");
    check.range(light.angle, 0.0, Pi / 2, "the angle");
}

void check(const Camera& camera, Check& check) {
    check.that(camera.vertical_fov > 0.0 && camera.vertical_fov < Pi,
               "the field of view is not between 0 and pi");
    check.that(camera.aspect_ratio >= 0.0 && std::isfinite(camera.aspect_ratio),
               "the aspect ratio is negative");
    check.known(camera.projection, Projection::Orthographic, "the projection");
    check.known(camera.aperture, Aperture::Gaussian, "the aperture");
    const auto length = [&](double metres, const std::string& what) {
        check.that(metres >= 0.0 && metres < MaxCoordinate, what + " is not between 0 and 1e15 m");
    };
    length(camera.orthographic_height, "the orthographic height");
    length(camera.lens_radius, "the lens radius");
    length(camera.focus_distance, "the focus distance");
    check.that(camera.orthographic_height > 0.0, "the orthographic height is 0");
    check.that(camera.focus_distance > 0.0, "the focus distance is 0");
}

void check(const Background& background, Check& check) {
    check.not_negative(background.color, "the colour");
    check.range(background.strength, 0.0, Largest, "the strength");
    check.finite(background.rotation, "the rotation");
    check.known(background.visible, VisibleBackground::Color, "what is visible of it");
    check.not_negative(background.visible_color, "the visible colour");
    check.range(background.visible_color.w, 0.0, 1.0, "the visible alpha");
}

void check(const Attachment& attachment, Check& check) {
    constexpr std::size_t MaxValue = 1 << 20;
    check.that(attachment.key.size() <= MaxName && attachment.value.size() <= MaxValue,
               "its key or value is longer than 4 KiB or 1 MiB");
}

}  // namespace

std::string describe(ObjectId id, const Object& object) {
    std::string text = std::string(name(kind(object))) + " " + std::to_string(id.value);
    if (const std::string& given = name(object); !given.empty()) text += " ('" + given.substr(0, 64) + "')";
    return text;
}

std::vector<std::string> problems_of(ObjectId id, const Object& object) {
    Check checks(id, object);
    checks.that(name(object).size() <= MaxName, "its name is longer than 4096 bytes");
    std::visit(
        [&]<class T>(const T& value) {
            check(value, checks);
            for_each_field<T>([&](unsigned field, auto member) {
                if constexpr (std::is_same_v<std::decay_t<decltype(value.*member)>, TextureSlot>) {
                    check(value.*member, "the " + in_words(field_name(kind(object), field)), checks);
                }
            });
        },
        object);
    return checks.take();
}

}  // namespace tessera::scene
