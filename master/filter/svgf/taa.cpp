#include "master/filter/svgf/taa.h"

#include <array>

namespace tessera::filter::svgf {

namespace {

constexpr std::size_t Chunk = 128, Wide = Chunk + 2;
using Lane = std::array<float, Wide>;  // entry k is pixel start + k - 1

// What the 3x3 pixels around every pixel of a piece of a row hold, first down the columns, then along the
// row.
struct Around {
    std::array<Lane, 4> least, most;
    Lane nearest, move_x, move_y;  // the surface next to the camera, and how it moved
};

void reduce(const Lane& from_least, const Lane& from_most, Lane& least, Lane& most) {
    for (std::size_t k = 1; k + 1 < Wide; ++k) {
        least[k] = std::min(std::min(from_least[k - 1], from_least[k + 1]), from_least[k]);
        most[k] = std::max(std::max(from_most[k - 1], from_most[k + 1]), from_most[k]);
    }
}

// Takes over the nearer surface's motion.
void take_nearer(const float* nearest, const float* x, const float* y, std::size_t count,
                 float* __restrict to, float* __restrict to_x, float* __restrict to_y) {
    for (std::size_t k = 0; k < count; ++k) {
        const bool nearer = nearest[k] > to[k];
        to_x[k] = nearer ? x[k] : to_x[k];
        to_y[k] = nearer ? y[k] : to_y[k];
        to[k] = nearer ? nearest[k] : to[k];
    }
}

}  // namespace

bool antialias(const Planes& picture, const Planes& before, const Guides& now, const Motion& motion,
               const Planes& newness, float ratio, Planes& out, RunContext& context) {
    const std::uint32_t width = picture.width(), height = picture.height(), components = picture.components();
    if (out.width() != width || out.height() != height || out.components() != components) {
        out = Planes(width, height, components);
    }
    const auto piece = [&](std::uint32_t y, std::uint32_t start) {
        const std::size_t count = std::min<std::size_t>(Chunk, width - start);
        Around column, around;
        std::array<std::array<float, Chunk>, 4> old;
        // Lanes of row `row`, edges repeated.
        const auto load = [&](const float* row, Lane& lane) {
            lane[0] = row[start > 0 ? start - 1 : 0];
            std::copy_n(row + start, count, lane.begin() + 1);
            std::fill(lane.begin() + 1 + static_cast<std::ptrdiff_t>(count), lane.end(),
                      row[std::min<std::size_t>(width - 1, start + count)]);
        };
        column.nearest.fill(-1.0f);
        for (std::uint32_t row = y > 0 ? y - 1 : 0; row <= std::min(y + 1, height - 1); ++row) {
            Lane lane, x, y_lane;
            for (std::uint32_t c = 0; c < components; ++c) {
                load(picture.row(c, row), lane);
                const bool first = row == (y > 0 ? y - 1 : 0);
                for (std::size_t k = 0; k < Wide; ++k) {
                    column.least[c][k] = first ? lane[k] : std::min(lane[k], column.least[c][k]);
                    column.most[c][k] = first ? lane[k] : std::max(lane[k], column.most[c][k]);
                }
            }
            load(now.inverse_depth.row(0, row), lane);
            load(motion.position.row(0, row), x);
            load(motion.position.row(1, row), y_lane);
            for (std::size_t k = 0; k < Wide; ++k) {
                const float at = static_cast<float>(static_cast<std::int32_t>(start + k)) - 1.0f;
                x[k] -= std::min(std::max(at, 0.0f), static_cast<float>(width - 1));
                y_lane[k] -= static_cast<float>(row);
            }
            take_nearer(lane.data(), x.data(), y_lane.data(), Wide, column.nearest.data(),
                        column.move_x.data(), column.move_y.data());
        }
        around.nearest = column.nearest;
        around.move_x = column.move_x;
        around.move_y = column.move_y;
        for (const std::size_t side : {0u, 2u}) {
            take_nearer(column.nearest.data() + side, column.move_x.data() + side,
                        column.move_y.data() + side, Chunk, around.nearest.data() + 1,
                        around.move_x.data() + 1, around.move_y.data() + 1);
        }
        for (std::uint32_t c = 0; c < components; ++c) {
            reduce(column.least[c], column.most[c], around.least[c], around.most[c]);
        }

        const float* fresh = newness.row(0, y) + start;
        std::array<float, Chunk> share;
        for (std::size_t k = 0; k < count; ++k) {
            const float px = static_cast<float>(static_cast<std::int32_t>(start + k)) + around.move_x[k + 1];
            const float py = static_cast<float>(y) + around.move_y[k + 1];
            const bool seen = px >= 0.0f && py >= 0.0f && px <= static_cast<float>(width - 1) &&
                              py <= static_cast<float>(height - 1);
            share[k] = seen ? std::min(1.0f, std::max(ratio, fresh[k])) : 1.0f;
            if (!seen) {
                for (std::uint32_t c = 0; c < components; ++c) old[c][k] = 0.0f;
                continue;
            }
            const auto x0 = static_cast<std::int32_t>(px), y0 = static_cast<std::int32_t>(py);
            const std::int32_t right = x0 + 1 < static_cast<std::int32_t>(width) ? 1 : 0;
            const std::size_t down = y0 + 1 < static_cast<std::int32_t>(height) ? width : 0;
            const float fx = px - static_cast<float>(x0), fy = py - static_cast<float>(y0);
            for (std::uint32_t c = 0; c < components; ++c) {
                const float* up = before.row(c, static_cast<std::uint32_t>(y0)) + x0;
                const float* low = up + down;
                old[c][k] = (1.0f - fy) * ((1.0f - fx) * up[0] + fx * up[right]) +
                            fy * ((1.0f - fx) * low[0] + fx * low[right]);
            }
        }
        for (std::uint32_t c = 0; c < components; ++c) {
            for (std::size_t k = 0; k < count; ++k) {
                old[c][k] = std::min(std::max(old[c][k], around.least[c][k + 1]), around.most[c][k + 1]);
            }
        }
        const float *r = picture.row(0, y) + start, *g = picture.row(1, y) + start,
                    *b = picture.row(2, y) + start;
        std::array<float, Chunk> part;
        for (std::size_t k = 0; k < count; ++k) {
            const float bright = std::max(std::max(r[k], g[k]), std::max(b[k], 0.0f));
            const float old_bright = std::max(std::max(old[0][k], old[1][k]), std::max(old[2][k], 0.0f));
            const float new_weight = share[k] / (1.0f + bright);
            const float old_weight = (1.0f - share[k]) / (1.0f + old_bright);
            part[k] = old_weight / (new_weight + old_weight);
        }
        for (std::uint32_t c = 0; c < components; ++c) {
            const float* here = picture.row(c, y) + start;
            float* __restrict to = out.row(c, y) + start;
            for (std::size_t k = 0; k < count; ++k) to[k] = here[k] + part[k] * (old[c][k] - here[k]);
        }
    };
    return for_rows(context, height, [&](std::uint32_t y) {
        for (std::uint32_t start = 0; start < width; start += Chunk) piece(y, start);
    });
}

}  // namespace tessera::filter::svgf
