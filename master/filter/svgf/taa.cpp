#include "master/filter/svgf/taa.h"

#include <array>

namespace tessera::filter::svgf {

namespace {

constexpr std::size_t Chunk = 128, Wide = Chunk + 2;
using Lane = std::array<float, Wide>;  // entry k is pixel start + k - 1

// Statistics of the 3x3 neighbourhood of every pixel of a piece of a row: first down the columns, then along
// the row.
struct Around {
    std::array<Lane, 4> least, most;
    Lane nearest, move_x, move_y;  // the surface nearest to the camera, and its motion
};

void reduce(const Lane& from_least, const Lane& from_most, Lane& least, Lane& most) {
    for (std::size_t k = 1; k + 1 < Wide; ++k) {
        least[k] = std::min(std::min(from_least[k - 1], from_least[k + 1]), from_least[k]);
        most[k] = std::max(std::max(from_most[k - 1], from_most[k + 1]), from_most[k]);
    }
}

// Keeps the motion of the nearer surface.
void take_nearer(const float* nearest, const float* x, const float* y, std::size_t count,
                 float* __restrict to, float* __restrict to_x, float* __restrict to_y) {
    for (std::size_t k = 0; k < count; ++k) {
        const bool nearer = nearest[k] > to[k];
        to_x[k] = nearer ? x[k] : to_x[k];
        to_y[k] = nearer ? y[k] : to_y[k];
        to[k] = nearer ? nearest[k] : to[k];
    }
}

using Texel = std::array<float, 4>;

// Rows and columns around the previous picture that repeat its edges: those that the taps of a spline reach.
constexpr std::uint32_t Before = 1, After = 2;

struct Frame {
    const Planes& picture;
    const Texel* texels;   // of the previous picture at pixel (0, 0)
    const float* alphas;   // the same, where there is a fourth component
    std::ptrdiff_t pitch;  // of both
    const Guides& now;
    const Motion& motion;
    std::uint32_t width, height, components;
};

// Part of a row.
struct Piece {
    std::uint32_t y, start;
    std::size_t count;
};

// The previous picture, reprojected to the pixels of a piece, and the weight of the new one.
struct Old {
    std::array<std::array<float, Chunk>, 4> color;
    std::array<float, Chunk> new_fraction;
};

// Edges are repeated.
void load(const float* row, const Frame& frame, const Piece& piece, Lane& lane) {
    lane[0] = row[piece.start > 0 ? piece.start - 1 : 0];
    std::copy_n(row + piece.start, piece.count, lane.begin() + 1);
    std::fill(lane.begin() + 1 + static_cast<std::ptrdiff_t>(piece.count), lane.end(),
              row[std::min<std::size_t>(frame.width - 1, piece.start + piece.count)]);
}

// Of the rows above, here and below, column by column.
Around columns_around(const Frame& frame, const Piece& piece) {
    Around column;
    column.nearest.fill(-1.0f);
    const std::uint32_t above = piece.y > 0 ? piece.y - 1 : 0;
    for (std::uint32_t row = above; row <= std::min(piece.y + 1, frame.height - 1); ++row) {
        Lane lane, x, y;
        for (std::uint32_t c = 0; c < frame.components; ++c) {
            load(frame.picture.row(c, row), frame, piece, lane);
            const bool first = row == above;
            for (std::size_t k = 0; k < Wide; ++k) {
                column.least[c][k] = first ? lane[k] : std::min(lane[k], column.least[c][k]);
                column.most[c][k] = first ? lane[k] : std::max(lane[k], column.most[c][k]);
            }
        }
        load(frame.now.inverse_depth.row(0, row), frame, piece, lane);
        load(frame.motion.position.row(0, row), frame, piece, x);
        load(frame.motion.position.row(1, row), frame, piece, y);
        for (std::size_t k = 0; k < Wide; ++k) {
            const float at = static_cast<float>(static_cast<std::int32_t>(piece.start + k)) - 1.0f;
            x[k] -= std::min(std::max(at, 0.0f), static_cast<float>(frame.width - 1));
            y[k] -= static_cast<float>(row);
        }
        take_nearer(lane.data(), x.data(), y.data(), Wide, column.nearest.data(), column.move_x.data(),
                    column.move_y.data());
    }
    return column;
}

void gather_neighbourhood(const Frame& frame, const Piece& piece, Around& around) {
    const Around column = columns_around(frame, piece);
    around.nearest = column.nearest;
    around.move_x = column.move_x;
    around.move_y = column.move_y;
    for (const std::size_t side : {0u, 2u}) {
        take_nearer(column.nearest.data() + side, column.move_x.data() + side, column.move_y.data() + side,
                    Chunk, around.nearest.data() + 1, around.move_x.data() + 1, around.move_y.data() + 1);
    }
    for (std::uint32_t c = 0; c < frame.components; ++c) {
        reduce(column.least[c], column.most[c], around.least[c], around.most[c]);
    }
}

// The four weights of a Catmull-Rom spline `t` behind the second one.
std::array<float, 4> spline(float t) {
    const float u = 1.0f - t;
    return {-0.5f * t * u * u, 1.0f + t * t * (1.5f * t - 2.5f), 1.0f + u * u * (1.5f * u - 2.5f),
            -0.5f * u * t * t};
}

// The previous picture at (px, py), which is inside.
void interpolate(const Frame& frame, float px, float py, std::size_t k, Old& old) {
    const auto x0 = static_cast<std::int32_t>(px), y0 = static_cast<std::int32_t>(py);
    const std::array<float, 4> across = spline(px - static_cast<float>(x0)),
                               down = spline(py - static_cast<float>(y0));
    const std::ptrdiff_t corner = (y0 - 1) * frame.pitch + x0 - 1;
    Texel sum{};
    for (std::ptrdiff_t row = 0; row < 4; ++row) {
        const Texel* texel = frame.texels + corner + row * frame.pitch;
        const float weight = down[static_cast<std::size_t>(row)];
        for (std::size_t c = 0; c < 4; ++c) {
            sum[c] += weight * ((across[0] * texel[0][c] + across[1] * texel[1][c]) +
                                (across[2] * texel[2][c] + across[3] * texel[3][c]));
        }
    }
    // Where a spline exceeds the brightest of the four texels around, its divisor may reach 0.
    const Texel* near = frame.texels + corner + frame.pitch + 1;
    const float least =
        std::min(std::min(near[0][3], near[1][3]), std::min(near[frame.pitch][3], near[frame.pitch + 1][3]));
    const float scale = 1.0f / std::max(sum[3], least);
    for (std::size_t c = 0; c < 3; ++c) old.color[c][k] = sum[c] * scale;
    if (frame.components < 4) return;
    float alpha = 0.0f;
    for (std::ptrdiff_t row = 0; row < 4; ++row) {
        for (std::ptrdiff_t column = 0; column < 4; ++column) {
            alpha += across[static_cast<std::size_t>(column)] * down[static_cast<std::size_t>(row)] *
                     frame.alphas[corner + row * frame.pitch + column];
        }
    }
    old.color[3][k] = alpha * scale;
}

// Clamped to the neighbourhood's colours; `fresh`: minimum weight of the new picture, like `ratio`.
void fetch_before(const Frame& frame, const Piece& piece, const Around& around, const float* fresh,
                  float ratio, Old& old) {
    const std::uint32_t width = frame.width, height = frame.height, components = frame.components;
    for (std::size_t k = 0; k < piece.count; ++k) {
        const float px =
            static_cast<float>(static_cast<std::int32_t>(piece.start + k)) + around.move_x[k + 1];
        const float py = static_cast<float>(piece.y) + around.move_y[k + 1];
        const bool seen = px >= 0.0f && py >= 0.0f && px <= static_cast<float>(width - 1) &&
                          py <= static_cast<float>(height - 1);
        old.new_fraction[k] = seen ? std::min(1.0f, std::max(ratio, fresh[k])) : 1.0f;
        if (!seen) {
            for (std::uint32_t c = 0; c < components; ++c) old.color[c][k] = 0.0f;
            continue;
        }
        interpolate(frame, px, py, k, old);
    }
    for (std::uint32_t c = 0; c < components; ++c) {
        for (std::size_t k = 0; k < piece.count; ++k) {
            old.color[c][k] =
                std::min(std::max(old.color[c][k], around.least[c][k + 1]), around.most[c][k + 1]);
        }
    }
}

// Bright colours count less, so that a single one does not flicker.
void blend(const Frame& frame, const Piece& piece, const Old& old, Planes& out) {
    const float *r = frame.picture.row(0, piece.y) + piece.start,
                *g = frame.picture.row(1, piece.y) + piece.start,
                *b = frame.picture.row(2, piece.y) + piece.start;
    std::array<float, Chunk> part;
    for (std::size_t k = 0; k < piece.count; ++k) {
        const float bright = std::max(std::max(r[k], g[k]), std::max(b[k], 0.0f));
        const float old_bright =
            std::max(std::max(old.color[0][k], old.color[1][k]), std::max(old.color[2][k], 0.0f));
        const float new_weight = old.new_fraction[k] / (1.0f + bright);
        const float old_weight = (1.0f - old.new_fraction[k]) / (1.0f + old_bright);
        part[k] = old_weight / (new_weight + old_weight);
    }
    for (std::uint32_t c = 0; c < frame.components; ++c) {
        const float* here = frame.picture.row(c, piece.y) + piece.start;
        float* __restrict to = out.row(c, piece.y) + piece.start;
        for (std::size_t k = 0; k < piece.count; ++k) to[k] = here[k] + part[k] * (old.color[c][k] - here[k]);
    }
}

}  // namespace

bool Antialiasing::compress(const Planes& before, RunContext& context) {
    const std::uint32_t width = before.width(), height = before.height();
    const std::size_t pitch = Before + width + After;
    texels_.resize(pitch * (Before + height + After));
    if (before.components() == 4) alphas_.resize(texels_.size());
    return for_rows(context, Before + height + After, [&](std::uint32_t row) {
        const std::uint32_t y = std::min(row > Before ? row - Before : 0, height - 1);
        const float *r = before.row(0, y), *g = before.row(1, y), *b = before.row(2, y);
        const float* alpha = before.components() == 4 ? before.row(3, y) : nullptr;
        for (std::size_t column = 0; column < pitch; ++column) {
            const std::size_t x = std::min<std::size_t>(column > Before ? column - Before : 0, width - 1);
            const float divisor = 1.0f / (1.0f + std::max(std::max(r[x], g[x]), std::max(b[x], 0.0f)));
            texels_[row * pitch + column] = {r[x] * divisor, g[x] * divisor, b[x] * divisor, divisor};
            if (alpha != nullptr) alphas_[row * pitch + column] = alpha[x] * divisor;
        }
    });
}

bool Antialiasing::run(const Planes& picture, const Planes& before, const Guides& now, const Motion& motion,
                       const Planes& newness, float ratio, Planes& out, RunContext& context) {
    if (!compress(before, context)) return false;
    const std::size_t pitch = Before + before.width() + After, first = Before * pitch + Before;
    const Frame frame{.picture = picture,
                      .texels = texels_.data() + first,
                      .alphas = alphas_.empty() ? nullptr : alphas_.data() + first,
                      .pitch = static_cast<std::ptrdiff_t>(pitch),
                      .now = now,
                      .motion = motion,
                      .width = picture.width(),
                      .height = picture.height(),
                      .components = picture.components()};
    if (out.width() != frame.width || out.height() != frame.height || out.components() != frame.components) {
        out = Planes(frame.width, frame.height, frame.components);
    }
    return for_rows(context, frame.height, [&](std::uint32_t y) {
        for (std::uint32_t start = 0; start < frame.width; start += Chunk) {
            const Piece piece{y, start, std::min<std::size_t>(Chunk, frame.width - start)};
            Around around;
            Old old;
            gather_neighbourhood(frame, piece, around);
            fetch_before(frame, piece, around, newness.row(0, y) + start, ratio, old);
            blend(frame, piece, old, out);
        }
    });
}

}  // namespace tessera::filter::svgf
