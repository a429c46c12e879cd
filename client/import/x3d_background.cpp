#include "client/import/x3d_background.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <numbers>

#include "client/import/x3d_fields.h"

namespace tessera::import {
namespace {

constexpr std::uint32_t SkyRows = 256, SkyColumns = 4;
constexpr double Pi = std::numbers::pi;

// A gradient: colours at angles, the first at 0.
struct Bands {
    std::vector<glm::vec3> colors;
    std::vector<float> angles;

    bool empty() const { return colors.empty(); }
    double end() const { return angles.back(); }
    glm::vec3 at(double angle) const {
        const auto after = std::upper_bound(angles.begin(), angles.end(), static_cast<float>(angle));
        const auto next = static_cast<std::size_t>(after - angles.begin());
        if (next == angles.size()) return colors.back();
        const float from = angles[next - 1], width = angles[next] - from;
        return glm::mix(colors[next - 1], colors[next], (static_cast<float>(angle) - from) / width);
    }
};

Bands read_bands(const X3dFields& fields, const char* colors, const char* angles) {
    Bands bands;
    std::string wrong;
    try {
        bands.colors = fields.vectors<glm::vec3>(colors);
        bands.angles = fields.numbers(angles);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::InvalidInput) throw;
        wrong = error.what();
    }
    if (wrong.empty() && !bands.empty() && bands.colors.size() != bands.angles.size() + 1)
        wrong = std::string(angles) + " must have one number less than there are colours";
    bands.angles.insert(bands.angles.begin(), 0.0f);
    if (!std::is_sorted(bands.angles.begin(), bands.angles.end()) || bands.angles.front() < 0.0f ||
        bands.angles.back() > static_cast<float>(Pi) + 1e-4f)
        wrong = std::string(angles) + " do not ascend from 0 to pi";
    for (const glm::vec3& color : bands.colors) {
        for (int i = 0; i < 3; ++i) {
            if (!(color[i] >= 0.0f && color[i] <= 1e12f)) wrong = std::string(colors) + " are negative";
        }
    }
    if (wrong.empty()) return bands;
    fields.report(wrong + ": this part is ignored, correct it");
    return {};
}

}  // namespace

scene::Background read_background(X3dDocument& document, pugi::xml_node node, SceneBuilder& builder) {
    const X3dFields fields(node, document.diagnostics());
    const Bands sky = read_bands(fields, "skyColor", "skyAngle"),
                ground = read_bands(fields, "groundColor", "groundAngle");
    for (const char* picture : {"backUrl", "bottomUrl", "frontUrl", "leftUrl", "rightUrl", "topUrl"}) {
        if (fields.has(picture))
            fields.report("has images: they are not supported, only the colours are used");
    }
    scene::Background background;
    background.name = x3d_name(node);
    if (ground.empty() && sky.colors.size() <= 1) {
        background.color = sky.empty() ? glm::vec3(0.0f) : sky.colors.front();
        return background;
    }
    std::vector<glm::vec3> texels;
    for (std::uint32_t row = 0; row < SkyRows; ++row) {
        const double from_zenith = Pi * (row + 0.5) / SkyRows, from_nadir = Pi - from_zenith;
        // The ground ends at its last angle; a single ground colour fills the half below the horizon.
        const double ground_end = ground.empty() ? 0.0 : ground.colors.size() == 1 ? Pi / 2 : ground.end();
        const glm::vec3 color = from_nadir < ground_end ? ground.at(from_nadir)
                                : sky.empty()           ? glm::vec3(0.0f)
                                                        : sky.at(from_zenith);
        texels.insert(texels.end(), SkyColumns, color);
    }
    scene::Texture map;
    map.name = background.name.empty() ? "sky" : background.name;
    map.width = SkyColumns;
    map.height = SkyRows;
    map.format = scene::TexelFormat::RgbFloat;
    map.wrap_t = scene::Wrap::Clamp;
    map.texels = builder.blob(texels);
    background.environment = builder.add(std::move(map));
    return background;
}

}  // namespace tessera::import
