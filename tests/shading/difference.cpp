#include "tests/shading/difference.h"

#include <algorithm>
#include <limits>

#include "tests/shading/evaluation.h"

namespace tessera::shading {

namespace {

constexpr double Infinite = std::numeric_limits<double>::infinity();
// Devices may flush what is smaller than 2^-126, and with it larger numbers that are calculated from it.
constexpr double Least = 0x1p-112;

bool has(const uvec2& mask, uint place) {
    return (mask[int(place / 32)] >> place % 32 & 1u) != 0u;
}

double ulp_of(double size) {
    int exponent = 0;
    std::frexp(std::max(size, Least), &exponent);
    return std::ldexp(1.0, exponent - 24);
}

double difference_of(float a, float b, double ulp) {
    if (float_bits(a) == float_bits(b) || (is_nan(a) && is_nan(b))) return 0.0;
    if (is_nan(a) || is_nan(b)) return Infinite;
    const auto flushed = [](float value) { return std::fabs(double(value)) < Least ? 0.0 : double(value); };
    // Infinity counts as the next binade: one ulp from the largest float.
    const auto finite = [&](float value) {
        return is_finite(value) ? flushed(value) : std::copysign(0x1p128, double(value));
    };
    return std::fabs(finite(a) - finite(b)) / ulp;
}

std::string text_of(const Outputs& y) {
    std::string text;
    for (uint i = 0; i < y.count; ++i) {
        char number[64];
        std::snprintf(number, sizeof number, " %.9g", double(float_from_bits(y.bits[i])));
        text += has(y.exact, i) ? " " + std::to_string(y.bits[i]) : number;
    }
    return text;
}

}  // namespace

double difference(const Outputs& a, const Outputs& b) {
    if (a.count != b.count || a.starts != b.starts || a.exact != b.exact) return Infinite;
    double worst = 0.0;
    for (uint first = 0, end = 0; first < a.count; first = end) {
        for (end = first + 1; end < a.count && !has(a.starts, end);) ++end;
        if (has(a.exact, first)) {
            if (a.bits[first] != b.bits[first]) return Infinite;
            continue;
        }
        double size = 0.0;
        for (uint i = first; i < end; ++i) {
            const float value = float_from_bits(a.bits[i]);
            if (is_finite(value)) size = std::max(size, std::fabs(double(value)));
        }
        for (uint i = first; i < end; ++i) {
            worst = std::max(
                worst, difference_of(float_from_bits(a.bits[i]), float_from_bits(b.bits[i]), ulp_of(size)));
        }
    }
    return worst;
}

std::vector<SharedFunction> functions_of(std::uint32_t list) {
#define FUNCTION(ordinary, edges, call) {#call, ordinary, edges, false},
#define DECIDES(ordinary, edges, call) {#call, ordinary, edges, true},
    // clang-format off
    static const std::vector<SharedFunction> Lists[FunctionListCount] = {
        {
#include "tests/shading/functions/numbers.inc"
        },
        {
#include "tests/shading/functions/lobes.inc"
        },
        {
#include "tests/shading/functions/textures.inc"
        },
        {
#include "tests/shading/functions/surfaces.inc"
        },
        {
#include "tests/shading/functions/lights.inc"
        },
        {
#include "tests/shading/functions/found.inc"
        },
        {
#include "tests/shading/functions/steps.inc"
        },
        {
#include "tests/shading/functions/branches.inc"
        },
        {
#include "tests/shading/functions/samples.inc"
        },
        {
#include "tests/shading/functions/surface_shaders.inc"
        },
        {
#include "tests/shading/functions/views.inc"
        },
        {
#include "tests/shading/functions/materials.inc"
        },
        {
#include "tests/shading/functions/media.inc"
        },
    };
    // clang-format on
    return Lists[list];
}

Difference largest_difference(std::span<const Outputs> a, std::span<const Outputs> b, std::size_t outside) {
    std::vector<std::pair<double, std::size_t>> all;
    for (std::size_t i = 0; i < a.size(); ++i) all.emplace_back(difference(a[i], b[i]), i);
    std::sort(all.rbegin(), all.rend());
    const auto [ulp, input] = all[outside];
    return {ulp, input, text_of(a[input]) + " and" + text_of(b[input])};
}

std::size_t count_beyond(std::span<const Outputs> a, std::span<const Outputs> b, double bound) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += difference(a[i], b[i]) > bound ? 1 : 0;
    return count;
}

}  // namespace tessera::shading
