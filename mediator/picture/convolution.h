#pragma once

#include <cstddef>
#include <vector>

namespace tessera::picture {

// One component of a picture, rows from the top.
struct Plane {
    std::size_t width = 0, height = 0;
    std::vector<float> values;

    Plane() = default;
    Plane(std::size_t w, std::size_t h) : width(w), height(h), values(w * h) {}
};

// Weights at -radius .. radius.
using Kernel = std::vector<float>;

// exp(-x^2 / (2 sigma^2)) at -radius .. radius, with sum 1.
Kernel gaussian(double sigma, int radius);

// Separable convolution by across(x) down(y), clamped at the border. Runs in the calling thread's TBB arena.
Plane convolve(const Plane& plane, const Kernel& across, const Kernel& down);

}  // namespace tessera::picture
