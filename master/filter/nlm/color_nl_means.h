#pragma once

#include <vector>

#include "mediator/filter/filter.h"

namespace tessera::filter {

struct ColorNlMeansSettings {
    std::uint32_t radius = 7, patch = 3;
    float k = 0.5f;        // how many standard deviations still count as equal
    float epsilon = 0.0f;  // of the squared difference, so that a picture without variance has weights too
};

// NL-means of a picture with known variances (Rousselle et al. 2012; E-L5 in its standard form), over a
// window of (2 radius + 1)^2 pixels and patches of (2 patch + 1)^2:
//
//     w(p, q) = exp(-max(0, mean over the patch of d(p + o, q + o)))
//     d(a, b) = (|c_a - c_b|^2 - V_a - min(V_a, V_b)) / (epsilon + k^2 (V_a + V_b))
//
// |.|^2 and V are sums over r, g, b, so that no channel is weighted more for a bright sample. Pairs out of
// the picture do not count. Not symmetric: an outlier averages over its neighbours, but does not contribute
// to them.
//
// For each offset every pair is computed once, and patches are box sums; rows of pairs stay in the cache.
class ColorNlMeans {
  public:
    // `match` is compared: r, g, b and the sum of their variances, within 1e18 and [0, 1e37]. `color` is
    // averaged, 3 or 4 components; pixels whose `known` is 0 have no weight. Where there is no weight at all
    // the colour stays. False: stopped.
    bool run(const Planes& match, const Planes& color, const Planes& known,
             const ColorNlMeansSettings& settings, Planes& out, RunContext& context);

  private:
    static constexpr std::uint32_t Band = 32;  // rows; fixed, so that bits do not depend on threads

    struct Workspace {
        std::vector<float> pairs;           // 2 patch + 1 rows, used in turn
        std::vector<float> columns;         // sums of these, `patch` zeros on both sides
        std::vector<float> weights;         // of a row
        std::vector<float> inverse_counts;  // of horizontal pairs within a patch
    };
    void run_offset(const Planes& match, const Planes& color, const Planes& known,
                    const ColorNlMeansSettings& settings, std::int64_t dx, std::int64_t dy,
                    std::int64_t first, std::int64_t last, Workspace& space, Planes& out);

    std::vector<Workspace> spaces_;  // one per band
    Planes weights_;
};

}  // namespace tessera::filter
