#include "mediator/display/stereo_packing.h"

#include <immintrin.h>

namespace tessera::display {

namespace {

constexpr EyeMix Plain{.left = {{{1, 0, 0}, {0, 0, 0}, {0, 0, 0}}},
                       .right = {{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};

// E. Dubois: A projection method to generate anaglyph stereo images, ICASSP 2001: red-cyan glasses in front
// of a monitor, least squares in CIE XYZ, linear rgb in and out. White stays white: rows add up to 1.
constexpr EyeMix Dubois{.left = {{{0.4561f, 0.500484f, 0.176381f},
                                  {-0.0400822f, -0.0378246f, -0.0157589f},
                                  {-0.0152161f, -0.0205971f, -0.00546856f}}},
                        .right = {{{-0.0434706f, -0.0879388f, -0.00155529f},
                                   {0.378476f, 0.73364f, -0.0184503f},
                                   {-0.0721527f, -0.112961f, 1.2264f}}}};

}  // namespace

void halve_columns(PlanarRow row, std::size_t count, std::size_t first, PlanarRow out) {
    for (std::size_t c = 0; c < 3; ++c) {
        const float* from = row.planes[c];
        float* to = out.planes[c] + first;
        for (std::size_t i = 0; i < count; ++i) to[i] = 0.5f * (from[2 * i] + from[2 * i + 1]);
    }
}

void average_rows(std::size_t count, PlanarRow row, PlanarRow out) {
    for (std::size_t c = 0; c < 3; ++c) {
        const float* from = row.planes[c];
        float* to = out.planes[c];
        for (std::size_t i = 0; i < count; ++i) to[i] = 0.5f * (from[i] + to[i]);
    }
}

const EyeMix& eye_mix(Stereo stereo) {
    return stereo == Stereo::AnaglyphDubois ? Dubois : Plain;
}

void mix_eyes(const EyeMix& mix, std::size_t count, PlanarRow left, PlanarRow right) {
    for (std::size_t i = 0; i < count; i += PackSize) {
        __m256 eyes[2][3], mixed[3];
        for (std::size_t c = 0; c < 3; ++c) {
            eyes[0][c] = _mm256_loadu_ps(left.planes[c] + i);
            eyes[1][c] = _mm256_loadu_ps(right.planes[c] + i);
        }
        for (std::size_t c = 0; c < 3; ++c) {
            mixed[c] = _mm256_setzero_ps();
            for (std::size_t from = 0; from < 3; ++from) {
                mixed[c] = _mm256_fmadd_ps(_mm256_set1_ps(mix.left[c][from]), eyes[0][from], mixed[c]);
                mixed[c] = _mm256_fmadd_ps(_mm256_set1_ps(mix.right[c][from]), eyes[1][from], mixed[c]);
            }
        }
        for (std::size_t c = 0; c < 3; ++c) _mm256_storeu_ps(right.planes[c] + i, mixed[c]);
    }
}

}  // namespace tessera::display
