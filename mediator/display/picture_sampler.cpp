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

// Two neighbours from exactly 12 bytes: r0 g0 b0 r1 | b0 r1 g1 b1; mixed by `across`.
struct ExactPairs {
    static __m256 load(const std::uint16_t* pixel) {
        long long left = 0, right = 0;
        std::memcpy(&left, pixel, sizeof left);
        std::memcpy(&right, pixel + 2, sizeof right);
        return _mm256_cvtph_ps(_mm_set_epi64x(right, left));
    }
    static __m128 second(__m256 pair) {
        const __m128 mixed = _mm256_extractf128_ps(pair, 1);
        return _mm_shuffle_ps(mixed, mixed, _MM_SHUFFLE(3, 3, 2, 1));
    }
};

// The same by one load of 16 bytes, where they are readable: r0 g0 b0 r1 | g1 b1 ? ?
struct WidePairs {
    static __m256 load(const std::uint16_t* pixel) {
        return _mm256_cvtph_ps(_mm_loadu_si128(reinterpret_cast<const __m128i*>(pixel)));
    }
    static __m128 second(__m256 pair) {
        return _mm256_castps256_ps128(
            _mm256_permutevar8x32_ps(pair, _mm256_setr_epi32(3, 4, 5, 5, 3, 4, 5, 5)));
    }
};

// Four pixels of rgb? each become r, g and b of four; black where the mask is 0.
void store_planar(__m128 (&pixels)[4], __m128 mask, PlanarRow out, std::size_t at) {
    _MM_TRANSPOSE4_PS(pixels[0], pixels[1], pixels[2], pixels[3]);
    for (std::size_t c = 0; c < 3; ++c) _mm_storeu_ps(out.planes[c] + at, _mm_and_ps(pixels[c], mask));
}

// For each of eight positions: the first of its four pixels, and the interpolation weights.
struct SamplePack {
    alignas(32) std::array<std::int32_t, PackSize> pixels;
    alignas(32) std::array<float, PackSize> across, down;
};

template <class Pairs>
void sample(const HalfPicture& picture, const SamplePack& positions, std::size_t below, __m256 mask,
            PlanarRow out, std::size_t at) {
    for (std::size_t half = 0; half < PackSize; half += 4) {
        __m128 values[4];
        for (std::size_t k = 0; k < 4; ++k) {
            const std::uint16_t* corner = picture.values + std::size_t{3} * positions.pixels[half + k];
            const __m256 upper = Pairs::load(corner), lower = Pairs::load(corner + below);
            const __m256 pair =
                _mm256_fmadd_ps(_mm256_set1_ps(positions.down[half + k]), _mm256_sub_ps(lower, upper), upper);
            const __m128 left = _mm256_castps256_ps128(pair), right = Pairs::second(pair);
            values[k] = _mm_fmadd_ps(_mm_set1_ps(positions.across[half + k]), _mm_sub_ps(right, left), left);
        }
        const __m128 is_there = half == 0 ? _mm256_castps256_ps128(mask) : _mm256_extractf128_ps(mask, 1);
        store_planar(values, is_there, out, at + half);
    }
}

// Position = scale x coordinate + offset, in pixels.
struct Scaling {
    float x = 1.0f, y = 1.0f, offset = 0.0f;
};

void sample_scaled(const HalfPicture& picture, const float* x, const float* y, const Scaling& scaling,
                   std::size_t count, PlanarRow out) {
    const __m256 zero = _mm256_setzero_ps();
    const __m256 last_x = _mm256_set1_ps(static_cast<float>(picture.width - 1));
    const __m256 last_y = _mm256_set1_ps(static_cast<float>(picture.height - 1));
    const __m256i before_x = _mm256_set1_epi32(static_cast<int>(picture.width) - 2);
    const __m256i before_y = _mm256_set1_epi32(std::max(static_cast<int>(picture.height) - 2, 0));
    const __m256i pitch = _mm256_set1_epi32(static_cast<int>(picture.width));
    // All pairs of rows but the last are followed by another row.
    const __m256i row_before = _mm256_sub_epi32(before_y, _mm256_set1_epi32(1));
    const __m256 scale_x = _mm256_set1_ps(scaling.x), scale_y = _mm256_set1_ps(scaling.y),
                 offset = _mm256_set1_ps(scaling.offset);
    const std::size_t below = picture.height > 1 ? std::size_t{3} * picture.width : 0;
    SamplePack positions;
    for (std::size_t i = 0; i < count; i += PackSize) {
        const __m256 there_x = _mm256_add_ps(_mm256_mul_ps(_mm256_loadu_ps(x + i), scale_x), offset);
        const __m256 there_y = _mm256_add_ps(_mm256_mul_ps(_mm256_loadu_ps(y + i), scale_y), offset);
        // The second operand where the first is NaN: such positions read the first pixel.
        const __m256 at_x = _mm256_min_ps(_mm256_max_ps(there_x, zero), last_x);
        const __m256 at_y = _mm256_min_ps(_mm256_max_ps(there_y, zero), last_y);
        const __m256i column = _mm256_min_epi32(_mm256_cvttps_epi32(at_x), before_x);
        const __m256i line = _mm256_min_epi32(_mm256_cvttps_epi32(at_y), before_y);
        _mm256_store_ps(positions.across.data(), _mm256_sub_ps(at_x, _mm256_cvtepi32_ps(column)));
        _mm256_store_ps(positions.down.data(), _mm256_sub_ps(at_y, _mm256_cvtepi32_ps(line)));
        _mm256_store_si256(reinterpret_cast<__m256i*>(positions.pixels.data()),
                           _mm256_add_epi32(_mm256_mullo_epi32(line, pitch), column));
        const __m256 is_there = _mm256_cmp_ps(there_x, there_y, _CMP_ORD_Q);
        const bool is_at_end = _mm256_movemask_epi8(_mm256_cmpgt_epi32(line, row_before)) != 0;
        if (is_at_end)
            sample<ExactPairs>(picture, positions, below, is_there, out, i);
        else
            sample<WidePairs>(picture, positions, below, is_there, out, i);
    }
}

}  // namespace

void sample_row(const HalfPicture& picture, const float* u, const float* v, std::size_t count,
                PlanarRow out) {
    const Scaling to_pixels{static_cast<float>(picture.width), static_cast<float>(picture.height), -0.5f};
    sample_scaled(picture, u, v, to_pixels, count, out);
}

void sample_row_at(const HalfPicture& picture, const float* x, const float* y, std::size_t count,
                   PlanarRow out) {
    sample_scaled(picture, x, y, {}, count, out);
}

void copy_row(const HalfPicture& picture, std::size_t y, PlanarRow out) {
    const std::uint16_t* row = picture.values + 3 * y * picture.width;
    const __m128 all = _mm_castsi128_ps(_mm_set1_epi32(-1));
    std::size_t i = 0;
    for (; i + 4 < picture.width; i += 4) {  // reads one value beyond the last pixel: the next pixel's
        __m128 values[4];
        for (std::size_t k = 0; k < 4; ++k) {
            long long bits = 0;
            std::memcpy(&bits, row + 3 * (i + k), sizeof bits);
            values[k] = _mm_cvtph_ps(_mm_cvtsi64_si128(bits));
        }
        store_planar(values, all, out, i);
    }
    for (; i < picture.width; ++i) {
        alignas(16) std::array<float, 4> rgb;
        _mm_store_ps(rgb.data(), rgb_of(row + 3 * i));
        for (std::size_t c = 0; c < 3; ++c) out.planes[c][i] = rgb[c];
    }
}

}  // namespace tessera::display
