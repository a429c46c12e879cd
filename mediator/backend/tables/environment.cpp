#include <algorithm>
#include <cmath>
#include <numbers>

#include "mediator/backend/tables/parts.h"
#include "mediator/shading/sampling.h"
#include "mediator/shading/textures.h"

namespace tessera::backend {

namespace {

using std::numbers::pi;

// The luminance at the center of each texel, as a sampling weight: the magnitude of negative values, 0 for values that
// are not finite.
std::vector<double> texel_luminances(const SceneTables& tables) {
    const shading::Scene scene = on_host(tables);
    const shading::Environment& sky = scene.environment;
    const std::uint32_t width = sky.map.width, height = sky.map.height;
    std::vector<double> texels;
    texels.reserve(std::size_t{width} * height);
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const glm::vec2 uv{(static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                               (static_cast<float>(y) + 0.5f) / static_cast<float>(height)};
            const glm::vec3 texel(shading::lookup(scene, sky.map, uv));
            const double luminance = double(shading::luminance(sky.color + sky.strength * texel));
            texels.push_back(std::isfinite(luminance) ? std::fabs(luminance) : 0.0);
        }
    }
    return texels;
}

// MIS compensation (Karlik et al. 2019): BSDF samples find the mean of the sky as well as light samples do, and need no shadow
// ray, so light samples go where it is brighter. The weight of a texel is the excess of the mean of its own luminance and that
// of its neighbourhood: a texel with a bright neighbour has a part of its light by bilinear filtering.
SkyMeans add_map_cdfs(SceneTables& tables) {
    shading::Environment& sky = tables.scene.environment;
    const std::int64_t width = sky.map.width, height = sky.map.height;
    const std::vector<double> texels = texel_luminances(tables);
    const auto texel = [&](std::int64_t x, std::int64_t y) {
        return texels[static_cast<std::size_t>(std::clamp<std::int64_t>(y, 0, height - 1) * width +
                                               (x + width) % width)];
    };
    const auto smoothed = [&](std::int64_t x, std::int64_t y) {
        double neighbours = 0.0;
        for (std::int64_t dy = -1; dy <= 1; ++dy) {
            for (std::int64_t dx = -1; dx <= 1; ++dx) neighbours += texel(x + dx, y + dy) / 9.0;
        }
        return 0.5 * (texel(x, y) + neighbours);
    };
    std::vector<double> shares(static_cast<std::size_t>(height));  // of one texel in the sphere, by row
    double sines = 0.0;
    for (std::int64_t y = 0; y < height; ++y) {
        double& share = shares[static_cast<std::size_t>(y)];
        share = std::sin(pi * (double(y) + 0.5) / double(height));
        sines += share;
    }
    for (double& share : shares) share /= sines * double(width);
    SkyMeans means;
    for (std::int64_t y = 0; y < height; ++y) {
        for (std::int64_t x = 0; x < width; ++x)
            means.luminance += texel(x, y) * shares[static_cast<std::size_t>(y)];
    }
    std::vector<double> row_weights(static_cast<std::size_t>(height));
    std::vector<double> weights(static_cast<std::size_t>(width));
    sky.column_cdf = static_cast<std::uint32_t>(tables.cdfs.size());
    // A difference below this is rounding: the sky is uniform.
    const double least = 1e-5 * means.luminance;
    for (std::int64_t y = 0; y < height; ++y) {
        double row = 0.0;
        for (std::int64_t x = 0; x < width; ++x) {
            const double excess = smoothed(x, y) - means.luminance;
            weights[static_cast<std::size_t>(x)] = excess > least ? excess : 0.0;
            row += weights[static_cast<std::size_t>(x)];
        }
        row_weights[static_cast<std::size_t>(y)] = row * shares[static_cast<std::size_t>(y)];
        means.excess += row_weights[static_cast<std::size_t>(y)];
        add_cdf(tables, weights);
    }
    sky.row_cdf = add_cdf(tables, row_weights);
    return means;
}

}  // namespace

std::uint32_t add_cdf(SceneTables& tables, const std::vector<double>& weights) {
    const auto first = static_cast<std::uint32_t>(tables.cdfs.size());
    double total = 0.0, sum = 0.0;
    for (const double weight : weights) total += weight;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        sum += weights[i];
        tables.cdfs.push_back(total > 0.0 ? static_cast<float>(sum / total)
                                          : static_cast<float>(i + 1) / static_cast<float>(weights.size()));
    }
    return first;
}

void add_environment(SceneTables& tables, const scene::Scene& scene, const Indices& textures) {
    const auto* root = scene.find_as<scene::Root>(scene::RootId);
    const auto* background = root ? scene.find_as<scene::Background>(root->background) : nullptr;
    if (background == nullptr) return;
    shading::Environment& sky = tables.scene.environment;
    sky.color = background->color;
    sky.strength = background->strength;
    const bool is_turned = background->map_center == scene::MapCenter::PositiveX;
    sky.rotation = static_cast<float>(double(background->rotation) - (is_turned ? 0.5 * pi : 0.0));
    sky.visible_color = background->visible_color;
    sky.shows_color = background->visible == scene::VisibleBackground::Color ? 1u : 0u;
    tables.sky = {.luminance = double(shading::luminance(sky.color))};
    const auto map = textures.find(background->environment);
    if (map != textures.end() && sky.strength > 0.0f) {
        sky.map = tables.textures[map->second];
        sky.map.wrap_s = shading::WrapRepeat;
        sky.map.wrap_t = shading::WrapClamp;
        tables.environment_texels = tables.texels[map->second];
        tables.sky = add_map_cdfs(tables);
        tables.scene.features |= shading::FeatureEnvironmentMap;
    }
    sky.emits = tables.sky.luminance > 0.0 ? 1u : 0u;
    if (sky.emits != 0u) tables.scene.features |= shading::FeatureEnvironment;
}

}  // namespace tessera::backend
