#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "mediator/frame/image.h"
#include "mediator/view/display_transform.h"

namespace tessera::picture {

// Exposure and view transform of one pixel: scene-linear Rec. 709 to display-linear Rec. 709.
//   neutral   Khronos PBR Neutral: colours up to 0.76 are kept, minus the 4 % reflection of a dielectric, so that
//             base colours are reproduced; brighter values are compressed and desaturated
//   agx       AgX (Troy Sobotka, 2022), its default contrast: 16.5 stops, bright colours go to white
//   reinhard  L (1 + L / white^2) / (1 + L) on luminance, so that colours keep their ratios (Reinhard et al. 2002,
//             equation 4)
//   linear    none: values above 1 are clipped by the encoding
// Negative values and NaN count as black.
class ViewTransform {
  public:
    // `exposure`: EV. `white`: only for reinhard, the luminance after exposure that maps to 1; 0 = 4.
    ViewTransform(view::ViewTransform kind, double exposure, double white = 0.0);
    std::array<float, 3> operator()(float r, float g, float b) const {
        const std::array<float, 3> light{clamped(gain_ * r), clamped(gain_ * g), clamped(gain_ * b)};
        return kind_ == view::ViewTransform::Linear ? light : curved(light);
    }

  private:
    static constexpr float MaxValue = 1e30f;  // so that no curve gives NaN
    static float clamped(float value) { return value > 0.0f ? std::min(value, MaxValue) : 0.0f; }  // NaN: 0
    std::array<float, 3> curved(const std::array<float, 3>& light) const;

    view::ViewTransform kind_;
    float gain_, inverse_white_square_;
};

// 8-bit sRGB (IEC 61966-2-1), 3 bytes a pixel, rows from the top. `image` has 3 components.
std::vector<std::uint8_t> srgb_bytes(const frame::Image& image, const ViewTransform& transform);

}  // namespace tessera::picture
