#pragma once

#include <cstddef>

namespace tessera::filter {

// Sums over squares of `n` x `n` values, computed by doubling: sums of 1, 2, 4, ... values give every n in
// log2 n steps, each a vectorised loop. No running sums, so that rounding of a bright value affects only the
// sums that contain it.
//
// `values`: rows of `pitch` numbers, (height + n - 1) of them with (width + n - 1) numbers each; they are
// overwritten. `sums`: height rows of `width` numbers without gaps; sum (x, y) covers values (x, y) ... (x +
// n - 1, y + n - 1). `between`: scratch for (height + n - 1) rows of `width`.
inline void box_sum(float* values, std::size_t pitch, std::size_t width, std::size_t height, std::size_t n,
                    float* between, float* sums) {
    const std::size_t rows = height + n - 1, columns = width + n - 1;
    // One step for all bits of n: `whole` gathers the parts, `part` doubles in length.
    for (std::size_t y = 0; y < rows; ++y) {
        float* __restrict part = values + y * pitch;
        float* __restrict whole = between + y * width;
        std::size_t done = 0;
        for (std::size_t length = 1; length <= n; length *= 2) {
            if (n & length) {
                const float* from = part + done;
                if (done == 0) {
                    for (std::size_t x = 0; x < width; ++x) whole[x] = from[x];
                } else {
                    for (std::size_t x = 0; x < width; ++x) whole[x] += from[x];
                }
                done += length;
            }
            if (2 * length <= n) {
                for (std::size_t x = 0; x + 2 * length <= columns; ++x) part[x] += part[x + length];
            }
        }
    }
    std::size_t done = 0;
    for (std::size_t length = 1; length <= n; length *= 2) {
        if (n & length) {
            const float* from = between + done * width;
            if (done == 0) {
                for (std::size_t i = 0; i < height * width; ++i) sums[i] = from[i];
            } else {
                for (std::size_t i = 0; i < height * width; ++i) sums[i] += from[i];
            }
            done += length;
        }
        if (2 * length <= n) {
            const std::size_t count = (rows - 2 * length + 1) * width;
            for (std::size_t i = 0; i < count; ++i) between[i] += between[i + length * width];
        }
    }
}

}  // namespace tessera::filter
