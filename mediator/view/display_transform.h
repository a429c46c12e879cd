#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <tuple>

#include "mediator/base/description.h"

namespace tessera::view {

// The curve from scene-linear light to display-linear light in [0, 1]; see mediator/picture/view_transform.h.
enum class ViewTransform : std::uint8_t { Neutral, Agx, Reinhard, Linear };
constexpr auto enumerators(ViewTransform) {
    return std::to_array<std::string_view>({"neutral", "agx", "reinhard", "linear"});
}

inline constexpr double MaxExposure = 60.0;  // EV, in both directions

// How scene-linear light is converted to 8-bit sRGB for PNG, JPEG or a terminal. Rendering does not depend on it.
struct DisplayTransform {
    ViewTransform view_transform = ViewTransform::Neutral;
    std::optional<double> exposure;  // EV: light is scaled by 2^exposure; none = measured (auto)
    friend auto operator<=>(const DisplayTransform&, const DisplayTransform&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "view_transform", &DisplayTransform::view_transform),
                          row(2, "exposure", &DisplayTransform::exposure));
    }
};

}  // namespace tessera::view
