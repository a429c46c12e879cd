#include "master/render/compose/layers.h"

#include <algorithm>
#include <limits>
#include <string>

#include "master/filter/pack.h"
#include "mediator/base/error.h"
#include "mediator/base/parallel.h"

namespace tessera::master {

namespace {

using filter::all;
using filter::IntPack;
using filter::Pack;
using filter::PackSize;

constexpr std::size_t Components = 4;  // r, g, b, alpha
constexpr std::size_t Planes = 5;      // and depth
// Pixels are processed in runs, plane after plane: the planes of a picture are often whole pages apart, so that their
// cache lines would evict each other from one cache set.
constexpr std::size_t RunLength = 512, RunsPerTask = 16;
constexpr float Infinity = std::numeric_limits<float>::infinity();
constexpr float Largest = std::numeric_limits<float>::max();

using Values = float[RunLength];

struct Sheet {
    Pack depth;
    Pack color[Components];
};

Sheet load(const Values* planes, std::size_t at) {
    Sheet sheet;
    for (std::size_t c = 0; c < 3; ++c) sheet.color[c] = filter::load(planes[c] + at);
    sheet.color[3] = filter::min(filter::max(filter::load(planes[3] + at), all(0.0f)), all(1.0f));
    sheet.depth = filter::min(filter::load(planes[4] + at), all(Infinity));
    return sheet;
}

void swap_where(IntPack which, Pack& a, Pack& b) {
    const Pack old = a;
    a = which ? b : a;
    b = which ? old : b;
}

// Stable: only a strictly nearer layer moves in front.
void exchange(Sheet& front, Sheet& back) {
    const IntPack swaps = back.depth < front.depth;
    swap_where(swaps, front.depth, back.depth);
    for (std::size_t c = 0; c < Components; ++c) swap_where(swaps, front.color[c], back.color[c]);
}

// Adds `below` where it is visible.
void lay_under(Sheet& sum, Pack& seen_through, const Sheet& below) {
    const IntPack shows = seen_through > all(0.0f);
    for (std::size_t c = 0; c < Components; ++c) {
        const Pack more = sum.color[c] + seen_through * below.color[c];
        sum.color[c] = shows ? filter::min(filter::max(more, all(-Largest)), all(Largest)) : sum.color[c];
    }
    seen_through *= 1.0f - below.color[3];
}

void compose_pack(const Values (*planes)[Planes], std::size_t layers, std::size_t at, Values* result) {
    Sheet sheets[MaxLayers];  // from the front
    // From the last layer on, which is in front of those as near as itself.
    sheets[0] = load(planes[layers - 1], at);
    for (std::size_t made = 1; made < layers; ++made) {
        sheets[made] = load(planes[layers - 1 - made], at);
        for (std::size_t i = made; i > 0; --i) exchange(sheets[i - 1], sheets[i]);
    }
    Pack seen_through = 1.0f - sheets[0].color[3];
    for (std::size_t i = 1; i < layers; ++i) lay_under(sheets[0], seen_through, sheets[i]);
    for (std::size_t c = 0; c < Components; ++c) filter::store(result[c] + at, sheets[0].color[c]);
}

void compose_run(std::span<const Layer> layers, std::size_t first, std::size_t count, filter::Planes& out) {
    alignas(64) Values planes[MaxLayers][Planes], result[Components];
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const Layer& layer = layers[i];
        const std::span<const float> sources[Planes]{layer.color[0], layer.color[1], layer.color[2],
                                                     layer.alpha, layer.depth};
        for (std::size_t p = 0; p < Planes; ++p) {
            std::copy_n(sources[p].data() + first, count, planes[i][p]);
            std::fill(planes[i][p] + count, planes[i][p] + RunLength, 0.0f);
        }
    }
    for (std::size_t at = 0; at < RunLength; at += PackSize) compose_pack(planes, layers.size(), at, result);
    for (std::uint32_t c = 0; c < Components; ++c) {
        std::copy_n(result[c], count, out.plane(c).data() + first);
    }
}

void check(std::span<const Layer> layers, std::size_t pixels) {
    if (layers.empty() || layers.size() > MaxLayers) {
        throw Error(ErrorCode::InvalidInput, std::to_string(layers.size()) +
                                                 " layers cannot be composed: give 1 to " +
                                                 std::to_string(MaxLayers));
    }
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const Layer& layer = layers[i];
        bool fits = layer.alpha.size() == pixels && layer.depth.size() == pixels;
        for (const auto& plane : layer.color) fits = fits && plane.size() == pixels;
        if (!fits) {
            throw Error(ErrorCode::InvalidInput, "layer " + std::to_string(i) +
                                                     " is of another size than the picture: render all "
                                                     "layers of a view at one size");
        }
    }
}

}  // namespace

void compose(std::span<const Layer> layers, std::uint32_t width, std::uint32_t height, filter::Planes& out,
             tbb::task_arena& arena) {
    const std::size_t pixels = std::size_t{width} * height;
    check(layers, pixels);
    if (out.width() != width || out.height() != height || out.components() != Components) {
        out = filter::Planes(width, height, Components);
    }
    constexpr std::size_t Task = RunLength * RunsPerTask;
    parallel_for(arena, (pixels + Task - 1) / Task, [&](std::size_t task) {
        const std::size_t end = std::min(pixels, (task + 1) * Task);
        for (std::size_t first = task * Task; first < end; first += RunLength) {
            compose_run(layers, first, std::min(RunLength, end - first), out);
        }
    });
}

}  // namespace tessera::master
