#include "mediator/picture/view_transform.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

#include "mediator/picture/srgb_bytes.h"

namespace tessera::picture {

namespace {

// Specification: Khronos Group, PBR Neutral Tone Mapper (2024).
glm::vec3 neutral(glm::vec3 color) {
    constexpr float F90 = 0.04f;  // reflection of a dielectric of index 1.5 at normal incidence
    constexpr float StartOfCompression = 0.8f - F90, Desaturation = 0.15f;
    const float minimum = std::min({color.r, color.g, color.b});
    const float offset = minimum <= 2.0f * F90 ? minimum - minimum * minimum / (4.0f * F90) : F90;
    color -= offset;
    const float peak = std::max({color.r, color.g, color.b});
    if (peak <= StartOfCompression) return color;
    constexpr float Rest = 1.0f - StartOfCompression;
    const float compressed = 1.0f - Rest * Rest / (peak + Rest - StartOfCompression);
    const float saturation = 1.0f / (Desaturation * (peak - compressed) + 1.0f);
    return color / peak * (compressed * saturation) + compressed * (1.0f - saturation);
}

// A sigmoid of slope 2 through (0, 0), the pivot and (1, 1); `power` is the curvature on either side.
float sigmoid(float x) {
    constexpr float Pivot = 20.0f / 33.0f;  // middle grey within the 16.5 stops
    const bool is_toe = x < Pivot;
    const float power = is_toe ? 3.0f : 3.25f;
    const float range = is_toe ? Pivot : 1.0f - Pivot;
    const float distance = std::fabs(x - Pivot) / range;
    const float scale = std::pow(4.0f * range, power) - 1.0f;  // so that the curve ends at (0, 0) or (1, 1)
    return 0.5f + 2.0f * (x - Pivot) * std::pow(1.0f + scale * std::pow(distance, power), -1.0f / power);
}

glm::vec3 agx(const glm::vec3& color) {
    static const glm::mat3 Inset(0.8424010709504686f, 0.04240107095046854f, 0.04240107095046854f,
                                 0.07843650156180276f, 0.8784365015618028f, 0.07843650156180276f,
                                 0.0791624274877287f, 0.0791624274877287f, 0.8791624274877287f);
    static const glm::mat3 Outset(glm::inverse(glm::dmat3(Inset)));
    const float min_stop = std::log2(0.18f) - 10.0f,
                stops = 16.5f;  // 10 stops below middle grey to 6.5 above
    const glm::vec3 inset = Inset * color;
    glm::vec3 curved;
    for (int c = 0; c < 3; ++c) {
        const float stop = std::log2(std::max(inset[c], std::numeric_limits<float>::min()));
        curved[c] = sigmoid(std::clamp((stop - min_stop) / stops, 0.0f, 1.0f));
    }
    const glm::vec3 encoded = Outset * curved;  // for a display of gamma 2.2
    glm::vec3 linear;
    for (int c = 0; c < 3; ++c) linear[c] = std::pow(std::clamp(encoded[c], 0.0f, 1.0f), 2.2f);
    return linear;
}

}  // namespace

ViewTransform::ViewTransform(view::ViewTransform kind, double exposure, double white)
    : kind_(kind),
      gain_(static_cast<float>(std::exp2(std::clamp(exposure, -view::MaxExposure, view::MaxExposure)))),
      inverse_white_square_(static_cast<float>(1.0 / (white > 0.0 ? white * white : 16.0))) {}

std::array<float, 3> ViewTransform::curved(const std::array<float, 3>& light) const {
    const glm::vec3 color(light[0], light[1], light[2]);
    glm::vec3 shown = color;
    switch (kind_) {
        case view::ViewTransform::Neutral:
            shown = neutral(color);
            break;
        case view::ViewTransform::Agx:
            shown = agx(color);
            break;
        case view::ViewTransform::Reinhard: {
            const float y = glm::dot(color, glm::vec3(0.2126f, 0.7152f, 0.0722f));
            shown *= (1.0f + y * inverse_white_square_) / (1.0f + y);
            break;
        }
        case view::ViewTransform::Linear:
            break;
    }
    return {shown.r, shown.g, shown.b};
}

std::vector<std::uint8_t> srgb_bytes(const frame::Image& image, const ViewTransform& transform) {
    static const SrgbBytes to_srgb;
    std::vector<std::uint8_t> bytes(image.pixel_count() * 3);
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const auto pixel = image.pixel(i);
        const std::array<float, 3> shown = transform(pixel[0], pixel[1], pixel[2]);
        for (std::size_t c = 0; c < 3; ++c) bytes[3 * i + c] = to_srgb(shown[c]);
    }
    return bytes;
}

}  // namespace tessera::picture
