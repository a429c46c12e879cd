#pragma once

#include <array>
#include <limits>
#include <vector>

#include "master/render/compose/layers.h"

namespace tessera::test {

inline constexpr float Infinity = std::numeric_limits<float>::infinity();

struct Pixel {
    std::array<float, 3> color{};
    float alpha = 0.0f, depth = Infinity;
};
using Rgba = std::array<float, 4>;

// A stack of layers of the same size.
class Stack {
  public:
    Stack(std::uint32_t width, std::uint32_t height, std::size_t layers)
        : width_(width), height_(height), planes_(layers, std::vector<float>(5 * pixels())) {}

    std::size_t pixels() const { return std::size_t{width_} * height_; }
    void put(std::size_t layer, std::size_t at, const Pixel& pixel) {
        float* values = planes_[layer].data() + at;
        for (std::size_t c = 0; c < 3; ++c) values[c * pixels()] = pixel.color[c];
        values[3 * pixels()] = pixel.alpha;
        values[4 * pixels()] = pixel.depth;
    }
    std::vector<master::Layer> layers() const {
        std::vector<master::Layer> result;
        for (const std::vector<float>& values : planes_) {
            const auto plane = [&](std::size_t p) {
                return std::span(values).subspan(p * pixels(), pixels());
            };
            result.push_back({{plane(0), plane(1), plane(2)}, plane(3), plane(4)});
        }
        return result;
    }
    filter::Planes composed() const {
        tbb::task_arena arena(2);
        filter::Planes out;
        master::compose(layers(), width_, height_, out, arena);
        return out;
    }

  private:
    std::uint32_t width_, height_;
    std::vector<std::vector<float>> planes_;  // r, g, b, alpha, depth of each layer
};

// One pixel of these layers.
inline Rgba composed(const std::vector<Pixel>& pixels) {
    Stack stack(1, 1, pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) stack.put(i, 0, pixels[i]);
    const filter::Planes out = stack.composed();
    return {out.plane(0)[0], out.plane(1)[0], out.plane(2)[0], out.plane(3)[0]};
}

}  // namespace tessera::test
