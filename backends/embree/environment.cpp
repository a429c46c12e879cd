#include "backends/embree/environment.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "mediator/shading/sampling.h"

namespace tessera::embree {

namespace {

using shading::luminance;
using shading::Pi;

// Where u falls in a cumulative sum, and how far between its neighbours (for the texel's inside).
struct Found {
    std::size_t index;
    float fraction;
    float probability;
};

Found find(std::span<const float> cumulative, float u) {
    const auto above = std::upper_bound(cumulative.begin(), cumulative.end(), u);
    auto index = static_cast<std::size_t>(above - cumulative.begin());
    index = std::min(index, cumulative.size() - 1);
    while (index > 0 && cumulative[index] == cumulative[index - 1])
        --index;  // an empty texel at the very end
    const float low = index == 0 ? 0.0f : cumulative[index - 1];
    const float width = cumulative[index] - low;
    return {index, width > 0.0f ? std::min(std::max((u - low) / width, 0.0f), 0.99999994f) : 0.5f, width};
}

std::vector<float> normalised(const std::vector<double>& weights) {
    std::vector<float> cumulative(weights.size());
    double total = 0.0, sum = 0.0;
    for (const double weight : weights) total += weight;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        sum += weights[i];
        cumulative[i] = total > 0.0 ? static_cast<float>(sum / total)
                                    : static_cast<float>(i + 1) / static_cast<float>(weights.size());
    }
    return cumulative;
}

}  // namespace

Environment::Environment(const scene::Background& background, const TextureData* map)
    : color_(background.color), strength_(background.strength), rotation_(background.rotation) {
    mean_luminance_ = luminance(color_);
    has_map_ = map != nullptr && strength_ > 0.0f;
    if (!has_map_) return;
    map_ = *map;
    map_.wrap_s = scene::Wrap::Repeat;
    map_.wrap_t = scene::Wrap::Clamp;
    const std::uint32_t width = map_.width, height = map_.height;
    std::vector<double> texels(std::size_t{width} * height);
    const auto at = [&](std::int64_t x, std::int64_t y) {
        const auto cx = static_cast<float>((x + width) % width),
                   cy = static_cast<float>(std::clamp<std::int64_t>(y, 0, height - 1));
        const glm::vec2 uv{(cx + 0.5f) / static_cast<float>(width), (cy + 0.5f) / static_cast<float>(height)};
        return double(luminance(color_ + strength_ * glm::vec3(lookup(map_, uv))));
    };
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) texels[std::size_t{y} * width + x] = at(x, y);
    }
    const auto texel = [&](std::int64_t x, std::int64_t y) {
        return texels[static_cast<std::size_t>(std::clamp<std::int64_t>(y, 0, height - 1)) * width +
                      static_cast<std::size_t>((x + width) % width)];
    };
    std::vector<double> row_weights(height);
    columns_.reserve(texels.size());
    double sphere = 0.0;
    for (std::int64_t y = 0; y < height; ++y) {
        const double sine = std::sin(double(Pi) * (double(y) + 0.5) / height);
        std::vector<double> weights(width);
        for (std::int64_t x = 0; x < width; ++x) {
            double neighbours = 0.0;
            for (std::int64_t dy = -1; dy <= 1; ++dy) {
                for (std::int64_t dx = -1; dx <= 1; ++dx) neighbours += texel(x + dx, y + dy) / 9.0;
            }
            weights[static_cast<std::size_t>(x)] = 0.5 * (texel(x, y) + neighbours);
            row_weights[static_cast<std::size_t>(y)] += weights[static_cast<std::size_t>(x)] * sine;
            sphere += texel(x, y) * sine;
        }
        const std::vector<float> row = normalised(weights);
        columns_.insert(columns_.end(), row.begin(), row.end());
    }
    rows_ = normalised(row_weights);
    mean_luminance_ = sphere * double(Pi) / (2.0 * width * height);
}

glm::vec2 Environment::to_map(const glm::vec3& direction) const {
    float u = 0.5f + (std::atan2(direction.x, -direction.z) + rotation_) / (2.0f * Pi);
    u -= std::floor(u);
    return {u, std::acos(std::min(std::max(direction.y, -1.0f), 1.0f)) / Pi};
}

glm::vec3 Environment::radiance(const glm::vec3& direction) const {
    if (!has_map_) return color_;
    return color_ + strength_ * glm::vec3(lookup(map_, to_map(direction)));
}

Environment::Sample Environment::sample(const glm::vec2& u) const {
    if (!has_map_) return {shading::sample_sphere(u), 1.0f / (4.0f * Pi)};
    const Found row = find(rows_, u.y);
    const Found column = find(std::span(columns_).subspan(row.index * map_.width, map_.width), u.x);
    const float theta = Pi * (static_cast<float>(row.index) + row.fraction) / static_cast<float>(map_.height);
    const float phi =
        2.0f * Pi *
            ((static_cast<float>(column.index) + column.fraction) / static_cast<float>(map_.width) - 0.5f) -
        rotation_;
    const glm::vec3 direction{std::sin(theta) * std::sin(phi), std::cos(theta),
                              -std::sin(theta) * std::cos(phi)};
    return {direction, pdf(direction)};
}

float Environment::pdf(const glm::vec3& direction) const {
    if (!has_map_) return 1.0f / (4.0f * Pi);
    const glm::vec2 uv = to_map(direction);
    const auto x = std::min(static_cast<std::size_t>(uv.x * static_cast<float>(map_.width)),
                            std::size_t{map_.width} - 1);
    const auto y = std::min(static_cast<std::size_t>(uv.y * static_cast<float>(map_.height)),
                            std::size_t{map_.height} - 1);
    const auto step = [](std::span<const float> sums, std::size_t i) {
        return sums[i] - (i == 0 ? 0.0f : sums[i - 1]);
    };
    const float row = step(rows_, y),
                column = step(std::span(columns_).subspan(y * map_.width, map_.width), x);
    const float sine = std::sqrt(std::max(0.0f, 1.0f - direction.y * direction.y));
    if (!(sine > 0.0f)) return 0.0f;
    return row * column * static_cast<float>(map_.width) * static_cast<float>(map_.height) /
           (2.0f * Pi * Pi * sine);
}

}  // namespace tessera::embree
