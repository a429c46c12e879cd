#pragma once

#include <vector>

#include "mediator/filter/filter.h"

namespace tessera::filter {

enum class DepthGuide {
    Logarithm,  // of the depth: differences are relative; a miss is far from every hit
    Disparity,  // mean depth over depth, at most 4: linear across a plane; a miss is 0
};
inline constexpr std::uint32_t GuideCount = 7;  // albedo, normal, depth

// The picture and its features as the windowed filters read them. A pixel without samples takes its values
// from the nearest pixel with samples, and has no weight for others: known() is 0 there.
class Features {
  public:
    // With `demodulate`, r, g, b are divided by the albedo; albedo components below 0.01 count as 1, since
    // such surfaces are not diffuse. False: stopped.
    bool prepare(const Inputs& inputs, bool demodulate, RunContext& context);

    const Planes& color() const { return color_; }  // Inputs::color_components()
    const Planes& known() const { return known_; }  // 1 or 0
    bool is_demodulated() const { return demodulated_; }
    const Planes& albedo() const { return albedo_; }  // the divisors of r, g, b, if demodulated

    // GuideCount planes within +-1e15, each times its scale: albedo x scales[0], normal x scales[1], depth x
    // scales[2]. Channels that are missing are 0. False: stopped.
    bool guides(const Inputs& inputs, DepthGuide depth, const std::array<float, 3>& scales, Planes& out,
                RunContext& context) const;

    // `from` is row y of a whole plane of the frame; `to` gets that row with its holes filled.
    void fill_row(const float* from, std::uint32_t y, float* to) const;

    // Turns row y of a filtered color() back into the picture: times the albedo, alpha clamped to [0, 1].
    void finish_row(Planes& picture, std::uint32_t y) const;

    static double bytes_per_pixel(std::uint32_t components, bool demodulate) {
        return 8.0 * components + 8.0 + (demodulate ? 24.0 : 0.0);
    }
    static constexpr double GuideBytes = 8.0 * GuideCount;

  private:
    struct PixelPosition {
        std::int32_t x, y;
    };
    void find_sources(const Inputs& inputs);

    Planes color_, known_, albedo_;
    std::vector<PixelPosition> sources_;  // per pixel, the nearest with samples; unused without holes
    bool has_holes_ = false, demodulated_ = false;
    std::uint32_t width_ = 0;
};

}  // namespace tessera::filter
