#include "master/filter/features.h"

#include <algorithm>
#include <limits>

#include "master/filter/kernels.h"

namespace tessera::filter {

namespace {

using frame::Channel;

constexpr float LeastAlbedo = 0.01f;
constexpr float MissLogarithm = 1e3f;  // ln(FLT_MAX) is 89
constexpr float MostDisparity = 4.0f;
constexpr float MostGuide = 1e15f;  // the squares of seven differences are still a float

float logarithm(float x) {
    return std::log(std::clamp(x, 1e-30f, 1e30f));
}

// Mean over pixels of 1 / depth where something was hit; sequential, so that the bits do not depend on the
// number of threads.
float mean_disparity(const Inputs& inputs) {
    double sum = 0.0, hits = 0.0;
    const auto depth = inputs.mean(Channel::Depth).plane(0);
    const auto counts = inputs.counts.plane(0);
    for (std::size_t i = 0; i < depth.size(); ++i) {
        const bool is_hit = counts[i] > 0.0f && std::isfinite(depth[i]);
        sum += is_hit ? 1.0 / std::max(depth[i], 1e-30f) : 0.0;
        hits += is_hit ? 1.0 : 0.0;
    }
    return hits > 0.0 ? static_cast<float>(sum / hits) : 1.0f;
}

}  // namespace

bool Features::prepare(const Inputs& inputs, bool demodulate, RunContext& context) {
    width_ = inputs.width;
    demodulated_ = demodulate && inputs.has(Channel::Albedo);
    const std::uint32_t components = inputs.color_components();
    shape(color_, inputs, components);
    shape(known_, inputs, 1);
    if (demodulated_) shape(albedo_, inputs, 3);
    const auto counts = inputs.counts.plane(0);
    has_holes_ = std::ranges::any_of(counts, [](float n) { return !(n > 0.0f); });
    if (has_holes_) find_sources(inputs);
    return for_rows(context, inputs.height, [&](std::uint32_t y) {
        const std::size_t first = std::size_t{y} * width_;
        float* known = known_.row(0, y);
        for (std::uint32_t x = 0; x < width_; ++x) known[x] = counts[first + x] > 0.0f ? 1.0f : 0.0f;
        for (std::uint32_t c = 0; c < components; ++c) {
            float* __restrict to = color_.row(c, y);
            fill_row(inputs.color(c).data() + first, y, to);
            if (!demodulated_ || c == 3) continue;
            float* __restrict albedo = albedo_.row(c, y);
            fill_row(inputs.mean(Channel::Albedo).row(c, y), y, albedo);
            for (std::uint32_t x = 0; x < width_; ++x) {
                albedo[x] = albedo[x] >= LeastAlbedo ? albedo[x] : 1.0f;
                to[x] /= albedo[x];
            }
        }
    });
}

// Two sweeps that propagate the nearest pixel with samples from neighbour to neighbour (Danielsson 1980);
// exact except for rare ties far inside holes.
void Features::find_sources(const Inputs& inputs) {
    const auto width = static_cast<std::int32_t>(inputs.width),
               height = static_cast<std::int32_t>(inputs.height);
    const auto counts = inputs.counts.plane(0);
    constexpr PixelPosition Nowhere{-1, -1};
    sources_.resize(inputs.pixel_count());
    const auto source = [&](std::int32_t x, std::int32_t y) -> PixelPosition& {
        return sources_[static_cast<std::size_t>(y) * inputs.width + static_cast<std::size_t>(x)];
    };
    const auto each = [&](const auto& function) {
        for (std::int32_t y = 0; y < height; ++y) {
            for (std::int32_t x = 0; x < width; ++x) function(x, y, source(x, y));
        }
    };
    each([&](std::int32_t x, std::int32_t y, PixelPosition& position) {
        const float n = counts[static_cast<std::size_t>(y) * inputs.width + static_cast<std::size_t>(x)];
        position = n > 0.0f ? PixelPosition{x, y} : Nowhere;
    });
    const auto ask = [&](std::int32_t x, std::int32_t y, std::int32_t dx, std::int32_t dy) {
        PixelPosition& ours = source(x, y);
        if ((ours.x == x && ours.y == y) || x + dx < 0 || x + dx >= width || y + dy < 0 || y + dy >= height)
            return;
        const PixelPosition theirs = source(x + dx, y + dy);
        if (theirs.x < 0) return;
        const auto distance = [&](PixelPosition position) {
            const std::int64_t u = position.x - x, v = position.y - y;
            return u * u + v * v;
        };
        if (ours.x < 0 || distance(theirs) < distance(ours)) ours = theirs;
    };
    const auto sweep = [&](std::int32_t y, std::int32_t behind) {
        for (std::int32_t x = 0; x < width; ++x) {
            for (std::int32_t dx = -1; dx <= 1; ++dx) ask(x, y, dx, behind);
            ask(x, y, -1, 0);
        }
        for (std::int32_t x = width; x-- > 0;) ask(x, y, 1, 0);
    };
    for (std::int32_t y = 0; y < height; ++y) sweep(y, -1);
    for (std::int32_t y = height; y-- > 0;) sweep(y, 1);
    each([&](std::int32_t x, std::int32_t y, PixelPosition& position) {
        if (position.x < 0) position = {x, y};  // no samples anywhere
    });
}

void Features::fill_row(const float* from, std::uint32_t y, float* to) const {
    if (!has_holes_) {
        std::copy(from, from + width_, to);
        return;
    }
    const std::size_t first = std::size_t{y} * width_;
    const float* plane = from - first;
    for (std::uint32_t x = 0; x < width_; ++x) {
        const PixelPosition position = sources_[first + x];
        to[x] = plane[static_cast<std::size_t>(position.y) * width_ + static_cast<std::size_t>(position.x)];
    }
}

bool Features::guides(const Inputs& inputs, DepthGuide depth, const std::array<float, 3>& scales, Planes& out,
                      RunContext& context) const {
    shape(out, inputs, GuideCount);
    const bool has_depth = inputs.has(Channel::Depth);
    const float disparity =
        has_depth && depth == DepthGuide::Disparity ? 1.0f / mean_disparity(inputs) : 1.0f;
    return for_rows(context, inputs.height, [&](std::uint32_t y) {
        for (std::uint32_t g = 0; g < GuideCount; ++g) {
            const Channel channel = g < 3 ? Channel::Albedo : g < 6 ? Channel::Normal : Channel::Depth;
            float* __restrict to = out.row(g, y);
            if (!inputs.has(channel)) {
                std::fill(to, to + width_, 0.0f);
                continue;
            }
            fill_row(inputs.mean(channel).row(g % 3, y), y, to);
            if (channel == Channel::Depth) {
                for (std::uint32_t x = 0; x < width_; ++x) {
                    const bool is_hit = to[x] <= std::numeric_limits<float>::max();
                    if (depth == DepthGuide::Logarithm) {
                        to[x] = is_hit ? logarithm(to[x]) : MissLogarithm;
                    } else {
                        to[x] = is_hit ? std::min(disparity / std::max(to[x], 1e-30f), MostDisparity) : 0.0f;
                    }
                }
            }
            const float scale = scales[g / 3];
            for (std::uint32_t x = 0; x < width_; ++x) {
                to[x] = std::min(std::max(to[x] * scale, -MostGuide), MostGuide);
            }
        }
    });
}

void Features::finish_row(Planes& picture, std::uint32_t y) const {
    for (std::uint32_t c = 0; c < picture.components(); ++c) {
        float* __restrict to = picture.row(c, y);
        if (c == 3) {
            for (std::uint32_t x = 0; x < width_; ++x) to[x] = std::min(std::max(to[x], 0.0f), 1.0f);
        } else if (demodulated_) {
            const float* albedo = albedo_.row(c, y);
            for (std::uint32_t x = 0; x < width_; ++x) to[x] *= albedo[x];
        }
    }
}

}  // namespace tessera::filter
