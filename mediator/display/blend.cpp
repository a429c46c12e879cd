#include "mediator/display/blend.h"

#include <algorithm>
#include <cmath>

#include "mediator/display/turn.h"

namespace tessera::display {

namespace {

struct Edges {
    double left = 0, right = 0, top = 0, bottom = 0;
};

// Maps the soft edges of the upright picture to edges of the device.
Edges device_edges(const Blend& blend, Turn turn) {
    switch (turn) {
        case Turn::None:
            break;
        case Turn::Quarter:
            return {.left = blend.top, .right = blend.bottom, .top = blend.right, .bottom = blend.left};
        case Turn::Half:
            return {.left = blend.right, .right = blend.left, .top = blend.bottom, .bottom = blend.top};
        case Turn::ThreeQuarters:
            return {.left = blend.bottom, .right = blend.top, .top = blend.left, .bottom = blend.right};
    }
    return {blend.left, blend.right, blend.top, blend.bottom};
}

std::vector<float> ramps(std::size_t pixels, double first, double last, double shape) {
    std::vector<float> weights(padded(pixels), 1.0f);
    for (std::size_t i = 0; i < pixels; ++i) {
        const double from = static_cast<double>(i) + 0.5, to = static_cast<double>(pixels) - from;
        double weight = 1.0;
        if (first > 0.0) weight *= soft_edge(from / first, shape);
        if (last > 0.0) weight *= soft_edge(to / last, shape);
        weights[i] = static_cast<float>(weight);
    }
    return weights;
}

// A grid is extrapolated beyond its outermost nodes: values may leave [0, 1].
std::vector<float> in_range(std::vector<float> values) {
    for (float& value : values) value = value > 0.0f ? std::min(value, 1.0f) : 0.0f;
    return values;
}

}  // namespace

double soft_edge(double t, double shape) {
    if (!(t > 0.0)) return 0.0;
    if (t >= 1.0) return 1.0;
    return t < 0.5 ? 0.5 * std::pow(2.0 * t, shape) : 1.0 - 0.5 * std::pow(2.0 * (1.0 - t), shape);
}

BlendMap::BlendMap(const Output& output, const scene::BlobStore& arrays) : width_(output.width) {
    const Blend& blend = output.blend;
    if (!blend.weights.empty()) {
        weights_ = in_range(DeviceGrid(blend.weights, output, arrays, "blend weights").all_pixels(0));
    } else if (const Edges edges = device_edges(blend, output.turn);
               edges.left > 0 || edges.right > 0 || edges.top > 0 || edges.bottom > 0) {
        across_ = ramps(output.width, edges.left, edges.right, blend.shape);
        down_ = ramps(output.height, edges.top, edges.bottom, blend.shape);
    }
    if (!blend.lift.empty())
        lift_ = in_range(DeviceGrid(blend.lift, output, arrays, "black levels").all_pixels(0));
}

void BlendMap::apply(std::size_t y, PlanarRow row) const {
    for (float* plane : row.planes) {
        if (!weights_.empty()) {
            const float* weights = weights_.data() + y * width_;
            for (std::size_t x = 0; x < width_; ++x) plane[x] *= weights[x];
        } else if (!across_.empty()) {
            const float* weights = across_.data();
            const float whole_row = down_[y];
            for (std::size_t x = 0; x < width_; ++x) plane[x] *= weights[x] * whole_row;
        }
        if (!lift_.empty()) {
            const float* lift = lift_.data() + y * width_;
            for (std::size_t x = 0; x < width_; ++x) plane[x] = lift[x] + (1.0f - lift[x]) * plane[x];
        }
    }
}

double BlendMap::weight(std::size_t x, std::size_t y) const {
    if (!weights_.empty()) return weights_[y * width_ + x];
    return across_.empty() ? 1.0 : double{across_[x]} * double{down_[y]};
}

}  // namespace tessera::display
