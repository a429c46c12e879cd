#include "master/filter/svgf/hole_fill.h"

#include <array>

namespace tessera::filter::svgf {

namespace {

struct Offset {
    std::uint32_t x, y;
};
// Children from the centre outwards.
constexpr std::array<Offset, 9> Children{
    {{1, 1}, {1, 0}, {0, 1}, {2, 1}, {1, 2}, {0, 0}, {2, 0}, {0, 2}, {2, 2}}};
constexpr float LeastWeight = 1e-3f;  // of a bilinear tap that is worth looking at

// The mean of the children of one texel. Fine: weight(x, y), id(x, y), value(plane, x, y).
template <class Fine>
std::uint32_t reduce(const Fine& fine, std::uint32_t x, std::uint32_t y, std::span<float> texel) {
    std::fill(texel.begin(), texel.end(), 0.0f);
    std::uint32_t id = 0;
    for (const Offset child : Children) {
        const std::uint32_t cx = 3 * x + child.x, cy = 3 * y + child.y;
        if (cx >= fine.width || cy >= fine.height) continue;
        const float weight = fine.weight(cx, cy);
        if (weight <= 0.0f) continue;
        if (texel[0] == 0.0f) id = fine.id(cx, cy);
        if (fine.id(cx, cy) != id) continue;
        texel[0] += weight;
        for (std::size_t p = 1; p < texel.size(); ++p) texel[p] += weight * fine.value(p - 1, cx, cy);
    }
    if (texel[0] > 0.0f) {
        for (std::size_t p = 1; p < texel.size(); ++p) texel[p] /= texel[0];
    }
    return id;
}

}  // namespace

bool HoleFill::run(const Planes& counts, std::vector<std::uint32_t>& ids, std::span<const PlaneView> planes,
                   RunContext& context) {
    struct Picture {
        const Planes& counts;
        const std::vector<std::uint32_t>& ids;
        std::span<const PlaneView> planes;
        std::uint32_t width, height;
        float weight(std::uint32_t x, std::uint32_t y) const { return counts.row(0, y)[x]; }
        std::uint32_t id(std::uint32_t x, std::uint32_t y) const { return ids[std::size_t{y} * width + x]; }
        float value(std::size_t p, std::uint32_t x, std::uint32_t y) const { return planes[p].row(y)[x]; }
    };
    struct Texels {
        const Level& level;
        std::size_t size;
        std::uint32_t width, height;
        const float* at(std::uint32_t x, std::uint32_t y) const {
            return level.texels.data() + (std::size_t{y} * width + x) * size;
        }
        float weight(std::uint32_t x, std::uint32_t y) const { return at(x, y)[0]; }
        std::uint32_t id(std::uint32_t x, std::uint32_t y) const {
            return level.ids[std::size_t{y} * width + x];
        }
        float value(std::size_t p, std::uint32_t x, std::uint32_t y) const { return at(x, y)[p + 1]; }
    };
    const std::uint32_t width = counts.width(), height = counts.height();
    const std::size_t size = planes.size() + 1;
    std::size_t used = 0;
    for (std::uint32_t w = width, h = height; w > 1 || h > 1;) {
        const bool finest = used == 0;
        if (levels_.size() == used) levels_.emplace_back();
        const std::uint32_t fine_width = w, fine_height = h;
        w = (w + 2) / 3;
        h = (h + 2) / 3;
        Level& level = levels_[used];
        level.width = w;
        level.height = h;
        level.texels.resize(std::size_t{w} * h * size);
        level.ids.resize(std::size_t{w} * h);
        const auto reduce_rows = [&](const auto& fine) {
            return for_rows(context, h, [&](std::uint32_t y) {
                for (std::uint32_t x = 0; x < w; ++x) {
                    const std::size_t i = std::size_t{y} * w + x;
                    level.ids[i] = reduce(fine, x, y, std::span(level.texels).subspan(i * size, size));
                }
            });
        };
        const bool done = finest ? reduce_rows(Picture{counts, ids, planes, width, height})
                                 : reduce_rows(Texels{levels_[used - 1], size, fine_width, fine_height});
        if (!done) return false;
        ++used;
        bool full = true;
        for (std::size_t i = 0; i < level.ids.size() && full; ++i) full = level.texels[i * size] > 0.0f;
        if (full) break;
    }
    return for_rows(context, height, [&](std::uint32_t y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            if (counts.row(0, y)[x] > 0.0f) continue;
            float scale = 1.0f;
            for (std::size_t l = 0; l < used; ++l) {
                const Level& level = levels_[l];
                scale /= 3.0f;
                const auto axis = [&](std::uint32_t i, std::uint32_t count,
                                      std::array<std::uint32_t, 2>& taps) {
                    const float at = std::max(0.0f, (static_cast<float>(i) + 0.5f) * scale - 0.5f);
                    taps[0] = std::min(static_cast<std::uint32_t>(at), count - 1);
                    taps[1] = std::min(taps[0] + 1, count - 1);
                    return std::min(1.0f, at - static_cast<float>(taps[0]));
                };
                std::array<std::uint32_t, 2> tx, ty;
                const float fx = axis(x, level.width, tx), fy = axis(y, level.height, ty);
                std::array<float, 4> weights;
                std::array<std::size_t, 4> texels;
                std::size_t best = 4;
                for (std::size_t t = 0; t < 4; ++t) {
                    texels[t] = std::size_t{ty[t / 2]} * level.width + tx[t % 2];
                    weights[t] = (t % 2 ? fx : 1.0f - fx) * (t / 2 ? fy : 1.0f - fy);
                    if (weights[t] < LeastWeight || level.texels[texels[t] * size] <= 0.0f) weights[t] = 0.0f;
                    if (weights[t] > 0.0f && (best == 4 || weights[t] > weights[best])) best = t;
                }
                if (best == 4) continue;
                const std::uint32_t id = level.ids[texels[best]];
                float sum = 0.0f;
                for (std::size_t t = 0; t < 4; ++t) {
                    if (level.ids[texels[t]] != id) weights[t] = 0.0f;
                    sum += weights[t];
                }
                ids[std::size_t{y} * width + x] = id;
                for (std::size_t p = 0; p < planes.size(); ++p) {
                    float value = 0.0f;
                    for (std::size_t t = 0; t < 4; ++t) {
                        value += weights[t] * level.texels[texels[t] * size + p + 1];
                    }
                    planes[p].row(y)[x] = value / sum;
                }
                break;
            }
        }
    });
}

}  // namespace tessera::filter::svgf
