#pragma once

#include "master/filter/kernels.h"
#include "master/filter/svgf/padded_planes.h"

namespace tessera::filter::pixel {

using svgf::PaddedPlanes;

// Pixels without samples (n = 0) and the pixels that stand in for them: the nearest with samples in the same
// row, else in the nearest row that has any. They lend their guide and their low-variance light.
class Holes {
  public:
    void find(const Inputs& inputs);
    bool any() const { return any_; }
    // The pixel itself when it has samples, or when none has.
    std::size_t origin(std::size_t pixel) const { return any_ ? origin_[pixel] : pixel; }

  private:
    bool any_ = false;
    std::vector<std::uint32_t> origin_;  // empty as long as there was never a hole
};

// Standard deviations of the range weights.
struct Tolerance {
    float color = 0.02f;  // sigma_c, linear
    float depth = 2.0f;   // sigma_d, metres
    float normal = 0.0f;  // sigma_n of unit normals' difference; 0: normals do not count
};

// Which pixels may give: those with samples, or holes that the first sweep has filled as well.
enum class Sources { Samples, All };

// By what pixels are compared: range colour, depth and, if asked for, normals (Schwenk 3.3.3, 3.6.2), scaled
// so that the weight of a neighbour is 2^-(squared distance). Misses are alike and unlike any hit. Columns
// beside the picture repeat its border but for their depth, which is unlike everything, so that they have no
// weight.
class Guide {
  public:
    void prepare(const Inputs& inputs, const Holes& holes, const Tolerance& tolerance, RunContext& context);

    std::uint32_t components() const { return features_.components(); }  // 4, or 7 with normals
    static constexpr std::uint32_t Depth = 3;
    static constexpr float Nowhere = 3e17f;  // scaled depth of what is unlike any pixel

    // Of a pixel that is being filtered.
    const float* target_row(std::uint32_t component, std::uint32_t y) const {
        return features_.row(component, y);
    }
    // Of its neighbours: with holes, a hole is unlike everything as long as it has not been filtered once.
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
