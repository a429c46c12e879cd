#include "master/filter/guided/local_models.h"

#include <algorithm>
#include <limits>

#include "master/filter/box_sum.h"
#include "master/filter/guided/ridge.h"
#include "master/filter/kernels.h"

namespace tessera::filter {

namespace {

constexpr std::size_t ModelSize = GuideCount + 1;  // slopes, then the value where all guides are 0
constexpr std::size_t Pairs = GuideCount * (GuideCount + 1) / 2;

// Indices of the sums of a fit: of known, of each guide, of each pair of guides, then per component of the
// colour itself and its products with the guides.
constexpr std::size_t sum_of_guide(std::size_t g) {
    return 1 + g;
}
constexpr std::size_t sum_of_pair(std::size_t i, std::size_t j) {
    return 1 + GuideCount + i * (i + 1) / 2 + j;
}
constexpr std::size_t sum_of_color(std::size_t c, std::size_t product) {
    return 1 + GuideCount + Pairs + c * ModelSize + product;
}

constexpr float MostColor = 1e30f;

}  // namespace

struct LocalModels::Frame {
    const Planes &guides, &color, &known;
    Planes& out;
    std::int64_t radius, width, height, ring;
    float ridge;
};

float* LocalModels::model_row(const Frame& frame, std::uint32_t number, std::int64_t y) {
    return models_.data() + (number * frame.ring + y % frame.ring) * frame.width;
}

bool LocalModels::run(const Planes& guides, const Planes& color, const Planes& known,
                      const LocalModelSettings& settings, Planes& out, RunContext& context) {
    const std::int64_t radius = settings.radius;
    const Frame frame{
        guides, color, known, out, radius, color.width(), color.height(), Strip + 2 * radius, settings.ridge};
    const std::size_t components = color.components(), n = 2 * settings.radius + 1,
                      surrounded = (Width + n - 1) * (Height + n - 1);
    models_.resize(static_cast<std::size_t>(frame.ring * frame.width) * ModelSize * components);
    spaces_.resize(static_cast<std::size_t>(context.arena.max_concurrency()));
    for (Space& space : spaces_) {
        space.values.resize(surrounded);
        space.between.resize(Width * (Height + n - 1));
        space.sums.resize(Width * Height * sum_of_color(components, 0));
        space.source.resize(surrounded * (1 + GuideCount + components));
    }
    return components == 4 ? run<4>(frame, context) : run<3>(frame, context);
}

template <std::uint32_t Components>
bool LocalModels::run(const Frame& frame, RunContext& context) {
    const auto columns =
        static_cast<std::uint32_t>((frame.width + std::int64_t{Width} - 1) / std::int64_t{Width});
    // function(left, top, bottom, space) for the tiles of rows [from, to).
    const auto for_tiles = [&](std::int64_t from, std::int64_t to, const auto& function) {
        const auto rows =
            static_cast<std::uint32_t>((to - from + std::int64_t{Height} - 1) / std::int64_t{Height});
        return for_rows(context, rows * columns, [&](std::uint32_t tile) {
            const std::int64_t left = std::int64_t{tile % columns} * std::int64_t{Width},
                               top = from + std::int64_t{tile / columns} * std::int64_t{Height};
            Space& space = spaces_[static_cast<std::size_t>(tbb::this_task_arena::current_thread_index())];
            function(left, top, std::min(top + std::int64_t{Height}, to), space);
        });
    };
    std::int64_t fitted = 0;
    for (std::int64_t top = 0; top < frame.height; top += Strip) {
        const std::int64_t bottom = std::min(top + Strip, frame.height),
                           seen = std::min(bottom + frame.radius, frame.height);
        const bool done = for_tiles(fitted, seen, [&](auto&&... tile) { fit<Components>(frame, tile...); }) &&
                          for_tiles(top, bottom, [&](auto&&... tile) { apply<Components>(frame, tile...); });
        if (!done) return false;
        fitted = seen;
    }
    return true;
}

// A tile with its margin, as stored in Space::source.
struct LocalModels::Tile {
    std::int64_t left, top, bottom;
    std::int64_t first_x, last_x, first_y, last_y;  // in the frame, with the surroundings
    std::size_t window, pitch, plane;

    Tile(const Frame& frame, std::int64_t from_left, std::int64_t from_top, std::int64_t to_bottom)
        : left(from_left),
          top(from_top),
          bottom(to_bottom),
          first_x(std::max<std::int64_t>(left - frame.radius, 0)),
          last_x(std::min(left + std::int64_t{Width} + frame.radius, frame.width)),
          first_y(std::max<std::int64_t>(top - frame.radius, 0)),
          last_y(std::min(top + std::int64_t{Height} + frame.radius, frame.height)),
          window(static_cast<std::size_t>(2 * frame.radius + 1)),
          pitch(Width + window - 1),
          plane(pitch * (Height + window - 1)) {}

    std::size_t count() const { return static_cast<std::size_t>(last_x - first_x); }
    std::size_t row(const Frame& frame, std::int64_t y) const {
        return static_cast<std::size_t>(y - top + frame.radius) * pitch +
               static_cast<std::size_t>(first_x - left + frame.radius);
    }
};

// Origins that values are relative to, to reduce cancellation: a value of the tile; of colours the minimum,
// which bright pixels do not affect.
template <std::uint32_t Components>
struct LocalModels::Origins {
    std::array<float, GuideCount> guide;
    std::array<float, Components> color;
};

template <std::uint32_t Components>
void LocalModels::load(const Frame& frame, const Tile& tile, Space& space, Origins<Components>& origins) {
    const std::size_t count = tile.count();
    const auto source = [&](std::size_t number) { return space.source.data() + number * tile.plane; };
    std::fill(space.source.begin(), space.source.end(), 0.0f);
    for (std::int64_t y = tile.first_y; y < tile.last_y; ++y) {
        std::copy_n(frame.known.row(0, static_cast<std::uint32_t>(y)) + tile.first_x, count,
                    source(0) + tile.row(frame, y));
    }
    // Unknown pixels are 0.
    const auto load_plane = [&](const Planes& planes, std::uint32_t number, float* to, float origin) {
        for (std::int64_t y = tile.first_y; y < tile.last_y; ++y) {
            const float* from = planes.row(number, static_cast<std::uint32_t>(y)) + tile.first_x;
            const float* known = source(0) + tile.row(frame, y);
            float* __restrict row = to + tile.row(frame, y);
            for (std::size_t x = 0; x < count; ++x) {
                row[x] = known[x] * (std::clamp(from[x], -MostColor, MostColor) - origin);
            }
        }
    };
    for (std::uint32_t g = 0; g < GuideCount; ++g) {
        origins.guide[g] = frame.guides.row(g, static_cast<std::uint32_t>(tile.top))[tile.left];
        load_plane(frame.guides, g, source(1 + g), origins.guide[g]);
    }
    for (std::uint32_t c = 0; c < Components; ++c) {
        float least = MostColor;
        for (std::int64_t y = tile.first_y; y < tile.last_y; ++y) {
            const float* from = frame.color.row(c, static_cast<std::uint32_t>(y)) + tile.first_x;
            const float* known = source(0) + tile.row(frame, y);
            for (std::size_t x = 0; x < count; ++x)
                least = known[x] > 0.0f ? std::min(least, from[x]) : least;
        }
        origins.color[c] = std::max(least, -MostColor);
        load_plane(frame.color, c, source(1 + GuideCount + c), origins.color[c]);
    }
}

template <std::uint32_t Components>
void LocalModels::sum_products(const Tile& tile, Space& space) {
    const auto source = [&](std::size_t number) { return space.source.data() + number * tile.plane; };
    const auto sum = [&](std::size_t number, std::size_t a, std::size_t b) {
        float* __restrict values = space.values.data();
        const float *first = source(a), *second = source(b);
        for (std::size_t i = 0; i < tile.plane; ++i) values[i] = first[i] * second[i];
        box_sum(values, tile.pitch, Width, Height, tile.window, space.between.data(),
                space.sums.data() + number * Width * Height);
    };
    sum(0, 0, 0);
    for (std::size_t i = 0; i < GuideCount; ++i) {
        sum(sum_of_guide(i), 1 + i, 0);
        for (std::size_t j = 0; j <= i; ++j) sum(sum_of_pair(i, j), 1 + i, 1 + j);
        for (std::size_t c = 0; c < Components; ++c) sum(sum_of_color(c, i), 1 + GuideCount + c, 1 + i);
    }
    for (std::size_t c = 0; c < Components; ++c) sum(sum_of_color(c, GuideCount), 1 + GuideCount + c, 0);
}

// The models of a row.
template <std::uint32_t Components>
void LocalModels::solve(const Frame& frame, const Tile& tile, const Space& space,
                        const Origins<Components>& origins, std::int64_t y) {
    using System = Ridge<GuideCount, Width>;
    using Row = typename System::Row;
    System system;
    std::array<Row, GuideCount> mean;
    const auto visible = static_cast<std::size_t>(std::min(std::int64_t{Width}, frame.width - tile.left));
    const auto sums = [&](std::size_t number) {
        return space.sums.data() + (number * Height + static_cast<std::size_t>(y - tile.top)) * Width;
    };
    Row inverse;
    for (std::size_t x = 0; x < Width; ++x) inverse[x] = sums(0)[x] > 0.0f ? 1.0f / sums(0)[x] : 0.0f;
    for (std::size_t i = 0; i < GuideCount; ++i) {
        for (std::size_t x = 0; x < Width; ++x) mean[i][x] = sums(sum_of_guide(i))[x] * inverse[x];
        for (std::size_t j = 0; j <= i; ++j) {
            const float* pair = sums(sum_of_pair(i, j));
            for (std::size_t x = 0; x < Width; ++x) {
                system.at(i, j)[x] = pair[x] * inverse[x] - mean[i][x] * mean[j][x];
            }
        }
    }
    system.factorise(frame.ridge);
    for (std::uint32_t c = 0; c < Components; ++c) {
        std::array<Row, GuideCount> slope;
        Row constant;
        const float* own = sums(sum_of_color(c, GuideCount));
        for (std::size_t x = 0; x < Width; ++x) constant[x] = own[x] * inverse[x];
        for (std::size_t i = 0; i < GuideCount; ++i) {
            const float* product = sums(sum_of_color(c, i));
            for (std::size_t x = 0; x < Width; ++x) {
                slope[i][x] = product[x] * inverse[x] - mean[i][x] * constant[x];
            }
        }
        system.solve(slope);
        for (std::size_t i = 0; i < GuideCount; ++i) {
            for (std::size_t x = 0; x < Width; ++x) {
                constant[x] -= slope[i][x] * (mean[i][x] + origins.guide[i]);
            }
            std::copy_n(slope[i].data(), visible,
                        model_row(frame, static_cast<std::uint32_t>(c * ModelSize + i), y) + tile.left);
        }
        const float* color = frame.color.row(c, static_cast<std::uint32_t>(y)) + tile.left;
        float* __restrict constants =
            model_row(frame, static_cast<std::uint32_t>(c * ModelSize + GuideCount), y) + tile.left;
        for (std::size_t x = 0; x < visible; ++x) {
            constants[x] = inverse[x] > 0.0f ? constant[x] + origins.color[c] : color[x];
        }
    }
}

template <std::uint32_t Components>
void LocalModels::fit(const Frame& frame, std::int64_t left, std::int64_t top, std::int64_t bottom,
                      Space& space) {
    const Tile tile(frame, left, top, bottom);
    Origins<Components> origins;
    load(frame, tile, space, origins);
    sum_products<Components>(tile, space);
    for (std::int64_t y = top; y < bottom; ++y) solve(frame, tile, space, origins, y);
}

template <std::uint32_t Components>
void LocalModels::apply(const Frame& frame, std::int64_t left, std::int64_t top, std::int64_t bottom,
                        Space& space) {
    const auto n = static_cast<std::size_t>(2 * frame.radius + 1);
    const std::size_t pitch = Width + n - 1;
    const std::int64_t first_x = std::max<std::int64_t>(left - frame.radius, 0),
                       last_x = std::min(left + std::int64_t{Width} + frame.radius, frame.width),
                       first_y = std::max<std::int64_t>(top - frame.radius, 0),
                       last_y = std::min(bottom + frame.radius, frame.height);
    const std::int64_t visible = std::min(std::int64_t{Width}, frame.width - left);
    std::array<float, Width> across;  // models in a row of a square
    for (std::int64_t x = left; x < left + visible; ++x) {
        across[static_cast<std::size_t>(x - left)] = static_cast<float>(
            std::min(x + frame.radius, frame.width - 1) - std::max<std::int64_t>(x - frame.radius, 0) + 1);
    }
    for (std::uint32_t c = 0; c < Components; ++c) {
        for (std::uint32_t i = 0; i < ModelSize; ++i) {
            std::fill(space.values.begin(), space.values.end(), 0.0f);
            for (std::int64_t y = first_y; y < last_y; ++y) {
                std::copy_n(model_row(frame, c * ModelSize + i, y) + first_x, last_x - first_x,
                            space.values.data() + static_cast<std::size_t>(y - top + frame.radius) * pitch +
                                static_cast<std::size_t>(first_x - left + frame.radius));
            }
            box_sum(space.values.data(), pitch, Width, Height, n, space.between.data(), space.sums.data());
            for (std::int64_t y = top; y < bottom; ++y) {
                const auto row = static_cast<std::uint32_t>(y);
                const auto down = static_cast<float>(std::min(y + frame.radius, frame.height - 1) -
                                                     std::max<std::int64_t>(y - frame.radius, 0) + 1);
                const float* sums = space.sums.data() + static_cast<std::size_t>(y - top) * Width;
                float* __restrict to = frame.out.row(c, row) + left;
                if (i == 0) std::fill_n(to, visible, 0.0f);
                const float* guide = i < GuideCount ? frame.guides.row(i, row) + left : nullptr;
                for (std::int64_t x = 0; x < visible; ++x) {
                    const float mean = sums[x] / (down * across[static_cast<std::size_t>(x)]);
                    to[x] += guide != nullptr ? mean * guide[x] : mean;
                }
            }
        }
    }
}

}  // namespace tessera::filter
