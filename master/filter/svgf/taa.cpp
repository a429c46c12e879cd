#include "master/filter/svgf/taa.h"

#include <array>

namespace tessera::filter::svgf {

bool antialias(const Planes& picture, const Planes& before, const Guides& now, const Motion& motion,
               const Planes& newness, float ratio, Planes& out, RunContext& context) {
    const std::uint32_t width = picture.width(), height = picture.height(), components = picture.components();
    if (out.width() != width || out.height() != height || out.components() != components) {
        out = Planes(width, height, components);
    }
    return for_rows(context, height, [&](std::uint32_t y) {
        const std::uint32_t first_row = y > 0 ? y - 1 : 0, last_row = std::min(y + 1, height - 1);
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::uint32_t first = x > 0 ? x - 1 : 0, last = std::min(x + 1, width - 1);
            std::array<float, 4> least, most, here, old{};
            float nearest = -1.0f;
            std::uint32_t near_x = x, near_y = y;
            for (std::uint32_t ty = first_row; ty <= last_row; ++ty) {
                for (std::uint32_t tx = first; tx <= last; ++tx) {
                    const float inverse = now.inverse_depth.row(0, ty)[tx];
                    if (inverse > nearest) {
                        nearest = inverse;
                        near_x = tx;
                        near_y = ty;
                    }
                }
            }
            for (std::uint32_t c = 0; c < components; ++c) {
                here[c] = least[c] = most[c] = picture.row(c, y)[x];
                for (std::uint32_t ty = first_row; ty <= last_row; ++ty) {
                    for (std::uint32_t tx = first; tx <= last; ++tx) {
                        const float v = picture.row(c, ty)[tx];
                        least[c] = std::min(least[c], v);
                        most[c] = std::max(most[c], v);
                    }
                }
            }
            const float move_x = motion.position.row(0, near_y)[near_x] - static_cast<float>(near_x);
            const float move_y = motion.position.row(1, near_y)[near_x] - static_cast<float>(near_y);
            const float px = static_cast<float>(x) + move_x, py = static_cast<float>(y) + move_y;
            const bool seen = px >= 0.0f && py >= 0.0f && px <= static_cast<float>(width - 1) &&
                              py <= static_cast<float>(height - 1);
            const float share = std::min(1.0f, std::max(ratio, newness.row(0, y)[x]));
            if (!seen || share >= 1.0f) {
                for (std::uint32_t c = 0; c < components; ++c) out.row(c, y)[x] = here[c];
                continue;
            }
            const auto x0 = static_cast<std::uint32_t>(px), y0 = static_cast<std::uint32_t>(py);
            const std::uint32_t x1 = std::min(x0 + 1, width - 1), y1 = std::min(y0 + 1, height - 1);
            const float fx = px - static_cast<float>(x0), fy = py - static_cast<float>(y0);
            for (std::uint32_t c = 0; c < components; ++c) {
                const float *up = before.row(c, y0), *down = before.row(c, y1);
                const float p = (1.0f - fy) * ((1.0f - fx) * up[x0] + fx * up[x1]) +
                                fy * ((1.0f - fx) * down[x0] + fx * down[x1]);
                old[c] = std::min(std::max(p, least[c]), most[c]);
            }
            const float new_weight = share / (1.0f + std::max({here[0], here[1], here[2], 0.0f}));
            const float old_weight = (1.0f - share) / (1.0f + std::max({old[0], old[1], old[2], 0.0f}));
            const float part = old_weight / (new_weight + old_weight);
            for (std::uint32_t c = 0; c < components; ++c) {
                out.row(c, y)[x] = here[c] + part * (old[c] - here[c]);
            }
        }
    });
}

}  // namespace tessera::filter::svgf
