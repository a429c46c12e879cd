#pragma once

#include <string>
#include <vector>

namespace tessera::tools::bench {

struct PlotSeries {
    std::string name, color;
    std::vector<std::pair<double, double>> points;  // non-positive points are skipped
};
struct Plot {
    std::string title, x_label, y_label;
    std::vector<PlotSeries> series;
};

// Both axes logarithmic, with a grid at powers of ten; as an inline SVG element. A line's name shows when the
// mouse is over it.
std::string as_svg(const Plot& plot);

// Distinguishable on white, by the filter's index in the list; repeats after twelve.
std::string line_color(std::size_t index);

}  // namespace tessera::tools::bench
