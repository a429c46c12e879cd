#pragma once

#include <vector>

#include "master/filter/svgf/hole_fill.h"

namespace tessera::filter {

// Fills what a filter of a limited window leaves in the middle of large holes, such as tiles that no node has rendered
// yet.
class FarHoles {
  public:
    // `reached`: 1 component, 0 where the window had no samples; only there `picture` changes, to the colours around.
    // False: stopped.
    bool fill(const Planes& reached, Planes& picture, RunContext& context);

  private:
    svgf::HoleFill pyramid_;
    std::vector<std::uint32_t> one_object_;
    std::vector<svgf::PlaneView> views_;
};

}  // namespace tessera::filter
