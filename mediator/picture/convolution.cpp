#include "mediator/picture/convolution.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace tessera::picture {

Kernel gaussian(double sigma, int radius) {
    Kernel kernel;
    double sum = 0.0;
    for (int x = -radius; x <= radius; ++x) sum += std::exp(-x * x / (2.0 * sigma * sigma));
    for (int x = -radius; x <= radius; ++x)
        kernel.push_back(static_cast<float>(std::exp(-x * x / (2.0 * sigma * sigma)) / sum));
    return kernel;
}

Plane convolve(const Plane& plane, const Kernel& across, const Kernel& down) {
    const std::size_t width = plane.width, height = plane.height;
    const std::size_t left = across.size() / 2, above = down.size() / 2;
    Plane rows(width, height), result(width, height);
    tbb::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
        std::vector<float> padded(width + across.size() - 1);
        const float* row = plane.values.data() + y * width;
        for (std::size_t x = 0; x < padded.size(); ++x)
            padded[x] = row[std::clamp(x, left, left + width - 1) - left];
        float* sums = rows.values.data() + y * width;
        for (std::size_t k = 0; k < across.size(); ++k)
            for (std::size_t x = 0; x < width; ++x) sums[x] += across[k] * padded[x + k];
    });
    tbb::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
        float* sums = result.values.data() + y * width;
        for (std::size_t k = 0; k < down.size(); ++k) {
            const float* row =
                rows.values.data() + (std::clamp(y + k, above, above + height - 1) - above) * width;
            for (std::size_t x = 0; x < width; ++x) sums[x] += down[k] * row[x];
        }
    });
    return result;
}

}  // namespace tessera::picture
