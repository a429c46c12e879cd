#include "client/import/default_environment.h"

#include <cmath>
#include <numbers>

namespace tessera::import {
namespace {

constexpr std::uint32_t Rows = 64, Columns = 4;
constexpr glm::vec3 Color{0.8f, 0.9f, 1.0f};
constexpr float GroundReflectance = 0.2f;

// `up`: sine of the elevation. A zenith radiance of 1 gives an irradiance of 7 pi / 9.
glm::vec3 radiance(float up) {
    if (up < 0.0f) return GroundReflectance * Color;
    return Color * (9.0f / 7.0f) * (1.0f + 2.0f * up) / 3.0f;
}

}  // namespace

ObjectId add_default_environment(SceneBuilder& builder) {
    std::vector<glm::vec3> texels;
    for (std::uint32_t row = 0; row < Rows; ++row) {
        const float from_zenith = std::numbers::pi_v<float> * (static_cast<float>(row) + 0.5f) / Rows;
        texels.insert(texels.end(), Columns, radiance(std::cos(from_zenith)));
    }
    scene::Texture sky;
    sky.name = "default environment";
    sky.width = Columns;
    sky.height = Rows;
    sky.format = scene::TexelFormat::RgbFloat;
    sky.wrap_t = scene::Wrap::Clamp;
    sky.texels = builder.blob(texels);
    return builder.add(std::move(sky));
}

}  // namespace tessera::import
