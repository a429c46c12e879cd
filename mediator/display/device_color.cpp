#include "mediator/display/device_color.h"

#include <immintrin.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace tessera::display {

namespace {

// Number of half floats from 0 to 1, in order of their bits.
constexpr std::size_t TableSize = 0x3c01;

// Thresholds of 8 x 8 pixels, 256 x (k + 0.5) / 64, so that every square of 2, 4 or 8 pixels has evenly
// distributed thresholds (Bayer 1973).
constexpr std::array<std::array<std::uint16_t, 8>, 8> make_thresholds() {
    std::array<std::array<std::uint16_t, 8>, 8> result{};
    for (unsigned y = 0; y < 8; ++y)
        for (unsigned x = 0; x < 8; ++x) {
            unsigned k = 0;
            for (unsigned bit = 0; bit < 3; ++bit) {
                const unsigned in_x = (x >> bit) & 1u, in_y = (y >> bit) & 1u;
                k = (k << 2) | ((in_x ^ in_y) << 1) | in_y;
            }
            result[y][x] = static_cast<std::uint16_t>(4 * k + 2);
        }
    return result;
}
constexpr auto Thresholds = make_thresholds();

__m256 clamped(__m256 value) {
    return _mm256_min_ps(_mm256_max_ps(value, _mm256_setzero_ps()), _mm256_set1_ps(1.0f));
}

// The codes of eight values.
__m128i codes(const std::uint16_t* table, __m256 value, __m128i thresholds) {
    alignas(16) std::array<std::uint16_t, PackSize> at;
    _mm_store_si128(reinterpret_cast<__m128i*>(at.data()), _mm256_cvtps_ph(clamped(value), 0));
    for (std::uint16_t& each : at) each = table[each];  // faster than a gather
    const __m128i between = _mm_load_si128(reinterpret_cast<const __m128i*>(at.data()));
    return _mm_srli_epi16(_mm_adds_epu16(between, thresholds), 8);
}

}  // namespace

DeviceColor::DeviceColor(const Color& color)
    : has_matrix_(color.matrix != glm::dmat3(1.0) || color.gain != glm::dvec3(1.0)),
      gamma_(color.gamma),
      curve_(color.curve),
      table_(TableSize) {
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) matrix_[r][c] = static_cast<float>(color.gain[r] * color.matrix[c][r]);
    for (std::size_t i = 0; i < TableSize; ++i) {
        const double linear = _cvtsh_ss(static_cast<std::uint16_t>(i));
        const double tolerance = std::max(linear * 0x1p-11, 0x1p-25);  // half a step of half floats
        table_[i] = static_cast<std::uint16_t>(std::lround(256.0 * code_between(linear, tolerance)));
    }
}

double DeviceColor::device_value(double linear) const {
    if (!curve_.empty()) {
        const double at = linear * static_cast<double>(curve_.size() - 1);
        const auto before = std::min(static_cast<std::size_t>(at), curve_.size() - 1);
        const std::size_t after = std::min(before + 1, curve_.size() - 1);
        const double fraction = at - static_cast<double>(before);
        return std::clamp(curve_[before] + fraction * (curve_[after] - curve_[before]), 0.0, 1.0);
    }
    if (gamma_ > 0.0) return std::pow(linear, 1.0 / gamma_);
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

double DeviceColor::light(double value) const {
    if (!curve_.empty()) {
        if (value <= curve_.front()) return 0.0;
        for (std::size_t i = 1; i < curve_.size(); ++i) {
            if (curve_[i] < value) continue;
            const double before = curve_[i - 1], fraction = (value - before) / (curve_[i] - before);
            return (static_cast<double>(i - 1) + fraction) / static_cast<double>(curve_.size() - 1);
        }
        return 1.0;
    }
    if (gamma_ > 0.0) return std::pow(value, gamma_);
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

// A code plus the fraction of the next one. Light that is within half float rounding of a code's is that code
// exactly.
double DeviceColor::code_between(double linear, double tolerance) const {
    const double smooth = 255.0 * device_value(linear);
    if (!curve_.empty()) return smooth;
    const double nearest = std::round(smooth);
    if (std::abs(light(nearest / 255.0) - linear) <= tolerance) return nearest;
    const double code = std::min(std::floor(smooth), 254.0);
    const double from = light(code / 255.0), to = light((code + 1.0) / 255.0);
    return code + std::clamp((linear - from) / (to - from), 0.0, 1.0);
}

void DeviceColor::apply_matrix(std::size_t count, PlanarRow row) const {
    if (!has_matrix_) return;
    float *const r = row.planes[0], *const g = row.planes[1], *const b = row.planes[2];
    const auto m = matrix_;
    for (std::size_t i = 0; i < count; ++i) {
        const float red = r[i], green = g[i], blue = b[i];
        r[i] = m[0][0] * red + m[0][1] * green + m[0][2] * blue;
        g[i] = m[1][0] * red + m[1][1] * green + m[1][2] * blue;
        b[i] = m[2][0] * red + m[2][1] * green + m[2][2] * blue;
    }
}

void DeviceColor::encode(std::size_t count, std::size_t y, PlanarRow row, std::uint8_t* space,
                         std::uint8_t* rgb) const {
    const __m128i thresholds = _mm_loadu_si128(reinterpret_cast<const __m128i*>(Thresholds[y % 8].data()));
    const __m128i without_gaps = _mm_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1);
    for (std::size_t i = 0; i < count; i += PackSize) {
        const __m128i r = codes(table_.data(), _mm256_loadu_ps(row.planes[0] + i), thresholds);
        const __m128i g = codes(table_.data(), _mm256_loadu_ps(row.planes[1] + i), thresholds);
        const __m128i b = codes(table_.data(), _mm256_loadu_ps(row.planes[2] + i), thresholds);
        const __m128i rg = _mm_or_si128(r, _mm_slli_epi16(g, 8));
        auto* to = reinterpret_cast<__m128i*>(space + 3 * i);
        auto* next = reinterpret_cast<__m128i*>(space + 3 * i + 12);
        _mm_storeu_si128(to, _mm_shuffle_epi8(_mm_unpacklo_epi16(rg, b), without_gaps));
        _mm_storeu_si128(next, _mm_shuffle_epi8(_mm_unpackhi_epi16(rg, b), without_gaps));
    }
    std::memcpy(rgb, space, 3 * count);
}

void DeviceColor::encode(std::size_t count, PlanarRow row, float* rgb) const {
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double linear = row.planes[c][i];
            rgb[3 * i + c] = static_cast<float>(device_value(linear > 0.0 ? std::min(linear, 1.0) : 0.0));
        }
}

}  // namespace tessera::display
