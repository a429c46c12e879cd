#include "mediator/display/picture_sampler.h"

#include <immintrin.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace tessera::display {

namespace {

__m128 rgb_of(const std::uint16_t* pixel) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, pixel, 3 * sizeof(std::uint16_t));
    return _mm_cvtph_ps(_mm_cvtsi64_si128(static_cast<long long>(bits)));
}

// Two neighbours, from 12 bytes and not one behind them: r0 g0 b0 r1 | b0 r1 g1 b1.
__m256 neighbours(const std::uint16_t* pixel) {
    long long left = 0, right = 0;
    std::memcpy(&left, pixel, sizeof left);
    std::memcpy(&right, pixel + 2, sizeof right);
    return _mm256_cvtph_ps(_mm_set_epi64x(right, left));
}

// Four pixels of rgb? each become r, g and b of four.
void store_planar(__m128 (&pixels)[4], PlanarRow out, std::size_t at) {
    _MM_TRANSPOSE4_PS(pixels[0], pixels[1], pixels[2], pixels[3]);
    for (std::size_t c = 0; c < 3; ++c) _mm_storeu_ps(out.planes[c] + at, pixels[c]);
}

}  // namespace

void sample_row(const HalfPicture& picture, const float* x, const float* y, std::size_t count,
                PlanarRow out) {
    const __m256 zero = _mm256_setzero_ps();
    const __m256 last_x = _mm256_set1_ps(static_cast<float>(picture.width - 1));
    const __m256 last_y = _mm256_set1_ps(static_cast<float>(picture.height - 1));
    const __m256i before_x = _mm256_set1_epi32(static_cast<int>(picture.width) - 2);
    const __m256i before_y = _mm256_set1_epi32(std::max(static_cast<int>(picture.height) - 2, 0));
    const __m256i pitch = _mm256_set1_epi32(static_cast<int>(picture.width));
    const std::size_t below = picture.height > 1 ? std::size_t{3} * picture.width : 0;
    alignas(32) std::array<std::int32_t, PackSize> pixels;
    alignas(32) std::array<float, PackSize> across, down;
    for (std::size_t i = 0; i < count; i += PackSize) {
        const __m256 there_x = _mm256_loadu_ps(x + i), there_y = _mm256_loadu_ps(y + i);
        // The second operand where the first is not a number: such places read the first pixel.
        const __m256 at_x = _mm256_min_ps(_mm256_max_ps(there_x, zero), last_x);
        const __m256 at_y = _mm256_min_ps(_mm256_max_ps(there_y, zero), last_y);
        const __m256i column = _mm256_min_epi32(_mm256_cvttps_epi32(at_x), before_x);
        const __m256i line = _mm256_min_epi32(_mm256_cvttps_epi32(at_y), before_y);
        _mm256_store_ps(across.data(), _mm256_sub_ps(at_x, _mm256_cvtepi32_ps(column)));
        _mm256_store_ps(down.data(), _mm256_sub_ps(at_y, _mm256_cvtepi32_ps(line)));
        _mm256_store_si256(reinterpret_cast<__m256i*>(pixels.data()),
                           _mm256_add_epi32(_mm256_mullo_epi32(line, pitch), column));
        for (std::size_t half = 0; half < PackSize; half += 4) {
            __m128 values[4];
            for (std::size_t k = 0; k < 4; ++k) {
                const std::uint16_t* corner = picture.values + std::size_t{3} * pixels[half + k];
                const __m256 upper = neighbours(corner), lower = neighbours(corner + below);
                const __m256 pair =
                    _mm256_fmadd_ps(_mm256_set1_ps(down[half + k]), _mm256_sub_ps(lower, upper), upper);
                const __m128 left = _mm256_castps256_ps128(pair), mixed = _mm256_extractf128_ps(pair, 1);
                const __m128 right = _mm_shuffle_ps(mixed, mixed, _MM_SHUFFLE(3, 3, 2, 1));
                values[k] = _mm_fmadd_ps(_mm_set1_ps(across[half + k]), _mm_sub_ps(right, left), left);
            }
            store_planar(values, out, i + half);
        }
        const __m256 is_there = _mm256_cmp_ps(there_x, there_y, _CMP_ORD_Q);
        for (float* plane : out.planes)
            _mm256_storeu_ps(plane + i, _mm256_and_ps(_mm256_loadu_ps(plane + i), is_there));
    }
}

void copy_row(const HalfPicture& picture, std::size_t y, PlanarRow out) {
    const std::uint16_t* row = picture.values + 3 * y * picture.width;
    std::size_t i = 0;
    for (; i + 4 < picture.width; i += 4) {  // reads one number behind the last pixel: it is the next one's
        __m128 values[4];
        for (std::size_t k = 0; k < 4; ++k) {
            long long bits = 0;
            std::memcpy(&bits, row + 3 * (i + k), sizeof bits);
            values[k] = _mm_cvtph_ps(_mm_cvtsi64_si128(bits));
        }
        store_planar(values, out, i);
    }
    for (; i < picture.width; ++i) {
        alignas(16) std::array<float, 4> rgb;
        _mm_store_ps(rgb.data(), rgb_of(row + 3 * i));
        for (std::size_t c = 0; c < 3; ++c) out.planes[c][i] = rgb[c];
    }
}

}  // namespace tessera::display
