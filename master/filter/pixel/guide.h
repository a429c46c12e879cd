#pragma once

#include "master/filter/kernels.h"
#include "master/filter/svgf/padded_planes.h"

namespace tessera::filter::pixel {

using svgf::PaddedPlanes;

// Pixels without samples (n = 0) and their substitutes: the nearest pixel with samples in the same row, else
// in the nearest row that has any. Holes take the guide and the low-variance light of their substitutes.
class Holes {
  public:
    void find(const Inputs& inputs);
    bool any() const { return any_; }
    // The pixel itself if it has samples, or if no pixel has.
    std::size_t origin(std::size_t pixel) const { return any_ ? origin_[pixel] : pixel; }

  private:
    bool any_ = false;
    std::vector<std::uint32_t> origin_;  // empty until the first hole
};

// Linear RGB, or CIELAB in hundredths (L* of white is 1), whose distances are more alike in the dark and the bright.
enum class ColorMetric { Linear, Lab };
// Metres, or the ratio of depths: then sigma_d is that of the logarithm, which does not depend on the scene's size.
enum class DepthMetric { Absolute, Relative };

// Standard deviations of the range weights.
struct Tolerance {
    float color = 0.02f;  // sigma_c, linear
    float depth = 2.0f;   // sigma_d, metres
    float normal = 0.0f;  // sigma_n of unit normals' difference; 0: normals do not count
    ColorMetric metric = ColorMetric::Linear;
    DepthMetric depth_metric = DepthMetric::Absolute;
};

// Which pixels contribute: only those with samples, or also holes that the first sweep has filled.
enum class Sources { Samples, All };

// Guide that pixels are compared by: headlight colour, depth and optionally normals (Schwenk 3.3.3, 3.6.2),
// scaled so that the weight of a neighbour is 2^-(squared distance). Misses match each other and no hit.
// Columns outside the picture repeat its border except for their depth, which matches nothing, so that they
// have no weight.
class Guide {
  public:
    void prepare(const Inputs& inputs, const Holes& holes, const Tolerance& tolerance, RunContext& context);

    std::uint32_t components() const { return features_.components(); }  // 4, or 7 with normals
    static constexpr std::uint32_t Depth = 3;
    static constexpr float Nowhere = 3e17f;  // scaled depth that matches no pixel

    // Features of the pixel being filtered.
    const float* target_row(std::uint32_t component, std::uint32_t y) const {
        return features_.row(component, y);
    }
    // Features of its neighbours; a hole matches nothing until it has been filtered once.
    const float* source_row(std::uint32_t component, std::uint32_t y, Sources sources) const {
        const bool closed = component == Depth && holes_ && sources == Sources::Samples;
        return closed ? source_depth_.row(0, y) : features_.row(component, y);
    }
    std::size_t pitch() const { return features_.pitch(); }

  private:
    PaddedPlanes features_;
    PaddedPlanes source_depth_;
    bool holes_ = false;
};

}  // namespace tessera::filter::pixel
