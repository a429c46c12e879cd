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
constexpr float LeastWeight = 1e-3f;  // below it a bilinear tap is ignored

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

// The finest level: the picture itself.
struct Picture {
    const Planes& counts;
    const std::vector<std::uint32_t>& ids;
    std::span<const PlaneView> planes;
    std::uint32_t width, height;

    float weight(std::uint32_t x, std::uint32_t y) const { return counts.row(0, y)[x]; }
    std::uint32_t id(std::uint32_t x, std::uint32_t y) const { return ids[std::size_t{y} * width + x]; }
    float value(std::size_t p, std::uint32_t x, std::uint32_t y) const { return planes[p].row(y)[x]; }
};

// A level of the pyramid.
struct Texels {
    const std::vector<float>& texels;
    const std::vector<std::uint32_t>& ids;
    std::size_t size;
    std::uint32_t width, height;

    const float* at(std::uint32_t x, std::uint32_t y) const {
        return texels.data() + (std::size_t{y} * width + x) * size;
    }
    float weight(std::uint32_t x, std::uint32_t y) const { return at(x, y)[0]; }
    std::uint32_t id(std::uint32_t x, std::uint32_t y) const { return ids[std::size_t{y} * width + x]; }
    float value(std::size_t p, std::uint32_t x, std::uint32_t y) const { return at(x, y)[p + 1]; }
};

// The two texels around pixel i along one axis, and the weight of the second.
float taps_around(std::uint32_t i, float scale, std::uint32_t count, std::array<std::uint32_t, 2>& taps) {
    const float at = std::max(0.0f, (static_cast<float>(i) + 0.5f) * scale - 0.5f);
    taps[0] = std::min(static_cast<std::uint32_t>(at), count - 1);
    taps[1] = std::min(taps[0] + 1, count - 1);
    return std::min(1.0f, at - static_cast<float>(taps[0]));
}

}  // namespace

template <class Fine>
bool HoleFill::reduce_to(Level& level, const Fine& fine, std::size_t size, RunContext& context) {
    level.width = (fine.width + 2) / 3;
    level.height = (fine.height + 2) / 3;
    level.texels.resize(std::size_t{level.width} * level.height * size);
    level.ids.resize(std::size_t{level.width} * level.height);
    return for_rows(context, level.height, [&](std::uint32_t y) {
        for (std::uint32_t x = 0; x < level.width; ++x) {
            const std::size_t i = std::size_t{y} * level.width + x;
            level.ids[i] = reduce(fine, x, y, std::span(level.texels).subspan(i * size, size));
        }
    });
}

bool HoleFill::build_pyramid(const Planes& counts, const std::vector<std::uint32_t>& ids,
                             std::span<const PlaneView> planes, RunContext& context) {
    const std::uint32_t width = counts.width(), height = counts.height();
    const std::size_t size = planes.size() + 1;
    used_ = 0;
    for (bool full = width <= 1 && height <= 1; !full; ++used_) {
        if (levels_.size() == used_) levels_.emplace_back();
        Level& level = levels_[used_];
        bool done = false;
        if (used_ == 0) {
            done = reduce_to(level, Picture{counts, ids, planes, width, height}, size, context);
        } else {
            const Level& fine = levels_[used_ - 1];
            done =
                reduce_to(level, Texels{fine.texels, fine.ids, size, fine.width, fine.height}, size, context);
        }
        if (!done) return false;
        full = true;
        for (std::size_t i = 0; i < level.ids.size() && full; ++i) full = level.texels[i * size] > 0.0f;
        full = full || (level.width <= 1 && level.height <= 1);
    }
    return true;
}

bool HoleFill::fill_from(const Level& level, float scale, std::uint32_t x, std::uint32_t y, std::uint32_t& id,
                         std::span<const PlaneView> planes) {
    const std::size_t size = planes.size() + 1;
    std::array<std::uint32_t, 2> tx, ty;
    const float fx = taps_around(x, scale, level.width, tx), fy = taps_around(y, scale, level.height, ty);
    std::array<float, 4> weights;
    std::array<std::size_t, 4> texels;
    std::size_t best = 4;
    for (std::size_t t = 0; t < 4; ++t) {
        texels[t] = std::size_t{ty[t / 2]} * level.width + tx[t % 2];
        weights[t] = (t % 2 ? fx : 1.0f - fx) * (t / 2 ? fy : 1.0f - fy);
        if (weights[t] < LeastWeight || level.texels[texels[t] * size] <= 0.0f) weights[t] = 0.0f;
        if (weights[t] > 0.0f && (best == 4 || weights[t] > weights[best])) best = t;
    }
    if (best == 4) return false;
    id = level.ids[texels[best]];
    float sum = 0.0f;
    for (std::size_t t = 0; t < 4; ++t) {
        if (level.ids[texels[t]] != id) weights[t] = 0.0f;
        sum += weights[t];
    }
    for (std::size_t p = 0; p < planes.size(); ++p) {
        float value = 0.0f;
        for (std::size_t t = 0; t < 4; ++t) value += weights[t] * level.texels[texels[t] * size + p + 1];
        planes[p].row(y)[x] = value / sum;
    }
    return true;
}

bool HoleFill::run(const Planes& counts, std::vector<std::uint32_t>& ids, std::span<const PlaneView> planes,
                   RunContext& context) {
    if (!build_pyramid(counts, ids, planes, context)) return false;
    const std::uint32_t width = counts.width();
    return for_rows(context, counts.height(), [&](std::uint32_t y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            if (counts.row(0, y)[x] > 0.0f) continue;
            float scale = 1.0f;
            for (std::size_t l = 0; l < used_; ++l) {
                scale /= 3.0f;
                if (fill_from(levels_[l], scale, x, y, ids[std::size_t{y} * width + x], planes)) break;
            }
        }
    });
}

}  // namespace tessera::filter::svgf
