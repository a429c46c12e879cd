#pragma once

#include <cstdint>
#include <vector>

namespace tessera::filter::svgf {

// Components of a signal: r, g, b, the variance of its luminance, and the weight that the pixel's own samples of this
// film have in the colour.
inline constexpr std::uint32_t VarianceComponent = 3, OwnWeightComponent = 4, SignalComponents = 5;

// Planes with zero padding before and after each row, so that loops may read up to Margin pixels out of
// bounds. Only [0, width) of a row is ever written.
class PaddedPlanes {
  public:
    static constexpr std::uint32_t Margin = 64;

    void fit(std::uint32_t width, std::uint32_t height, std::uint32_t components) {
        if (width == width_ && height == height_ && components == components_) return;
        width_ = width;
        height_ = height;
        components_ = components;
        pitch_ = (width + 15) / 16 * 16 + Margin;
        values_.assign(std::size_t{components} * height * pitch_ + Margin, 0.0f);
    }
    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }
    std::uint32_t components() const { return components_; }
    std::size_t pitch() const { return pitch_; }
    float* row(std::uint32_t component, std::uint32_t y) { return values_.data() + offset(component, y); }
    const float* row(std::uint32_t component, std::uint32_t y) const {
        return values_.data() + offset(component, y);
    }

  private:
    std::size_t offset(std::uint32_t component, std::uint32_t y) const {
        return (std::size_t{component} * height_ + y) * pitch_ + Margin;
    }

    std::uint32_t width_ = 0, height_ = 0, components_ = 0;
    std::size_t pitch_ = 0;
    std::vector<float> values_;
};

}  // namespace tessera::filter::svgf
