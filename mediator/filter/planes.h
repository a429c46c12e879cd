#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mediator/frame/image.h"

namespace tessera::filter {

// A picture as one array per component, each in raster order, so that a row of one component is contiguous
// and inner loops vectorise. No statistics.
class Planes {
  public:
    Planes() = default;
    Planes(std::uint32_t width, std::uint32_t height, std::uint32_t components)
        : width_(width),
          height_(height),
          components_(components),
          values_(std::size_t{width} * height * components) {}

    // The values are undefined afterwards; reuses the memory if it suffices.
    void resize(std::uint32_t width, std::uint32_t height, std::uint32_t components) {
        width_ = width;
        height_ = height;
        components_ = components;
        values_.resize(std::size_t{width} * height * components);
    }
    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }
    std::uint32_t components() const { return components_; }
    std::size_t pixel_count() const { return std::size_t{width_} * height_; }
    bool empty() const { return values_.empty(); }

    std::span<float> plane(std::uint32_t component) {
        return {values_.data() + component * pixel_count(), pixel_count()};
    }
    std::span<const float> plane(std::uint32_t component) const {
        return {values_.data() + component * pixel_count(), pixel_count()};
    }
    float* row(std::uint32_t component, std::uint32_t y) {
        return values_.data() + component * pixel_count() + std::size_t{y} * width_;
    }
    const float* row(std::uint32_t component, std::uint32_t y) const {
        return values_.data() + component * pixel_count() + std::size_t{y} * width_;
    }
    std::span<float> values() { return values_; }
    std::span<const float> values() const { return values_; }
    std::size_t byte_size() const { return values_.size() * sizeof(float); }

  private:
    std::uint32_t width_ = 0, height_ = 0, components_ = 0;
    std::vector<float> values_;
};

// With interleaved components, for files.
frame::Image interleaved(const Planes& planes);

}  // namespace tessera::filter
