#include "tests/bench/filters/svg_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "client/tools/formatted.h"
#include "client/tools/markup.h"

namespace tessera::tools::bench {

namespace {

constexpr double Width = 520, Height = 340, Left = 62, Right = 12, Top = 30, Bottom = 44;

bool is_drawn(const std::pair<double, double>& point) {
    return std::isfinite(point.first) && std::isfinite(point.second) && point.first > 0.0 &&
           point.second > 0.0;
}

// One logarithmic axis: maps values to page coordinates.
class Axis {
  public:
    Axis(double from, double to) : from_(from), to_(to) {}
    void include(double value) {
        low_ = is_empty_ ? value : std::min(low_, value);
        high_ = is_empty_ ? value : std::max(high_, value);
        is_empty_ = false;
    }
    void close() {  // padding at both ends
        const double air = std::pow(std::max(high_ / low_, 1.5), 0.05);
        low_ /= air;
        high_ *= air;
    }
    double to_pixels(double value) const {
        return from_ + (to_ - from_) * std::log(value / low_) / std::log(high_ / low_);
    }
    // Powers of ten, and 2 and 5 times these when the axis is short.
    std::vector<double> ticks() const {
        const bool is_short = high_ / low_ < 200.0;
        std::vector<double> found;
        for (int exponent = static_cast<int>(std::floor(std::log10(low_))); std::pow(10.0, exponent) <= high_;
             ++exponent) {
            for (const double step : {1.0, 2.0, 5.0}) {
                const double value = step * std::pow(10.0, exponent);
                if (value >= low_ && value <= high_ && (is_short || step == 1.0)) found.push_back(value);
            }
        }
        return found;
    }

  private:
    double from_, to_, low_ = 1.0, high_ = 10.0;
    bool is_empty_ = true;
};

}  // namespace

std::string line_color(std::size_t index) {
    constexpr std::array Colors{"#222222", "#d62728", "#1f77b4", "#2ca02c", "#9a9a9a", "#bcbd22",
                                "#8c564b", "#e377c2", "#17becf", "#ff7f0e", "#9467bd", "#5b7c00"};
    return Colors[index % Colors.size()];
}

std::string as_svg(const Plot& plot) {
    Axis x(Left, Width - Right), y(Height - Bottom, Top);
    for (const PlotSeries& series : plot.series) {
        for (const auto& point : series.points) {
            if (!is_drawn(point)) continue;
            x.include(point.first);
            y.include(point.second);
        }
    }
    x.close();
    y.close();
    std::string svg = formatted("<svg viewBox=\"0 0 %g %g\" role=\"img\">", Width, Height);
    svg += formatted("<text x=\"%g\" y=\"18\" class=\"title\">", Left) + escaped(plot.title) + "</text>";
    for (const double tick : x.ticks()) {
        const double at = x.to_pixels(tick);
        svg += formatted("<path class=\"grid\" d=\"M%.1f %g V%g\"/>", at, Top, Height - Bottom);
        svg += formatted("<text x=\"%.1f\" y=\"%g\" text-anchor=\"middle\">%g</text>", at,
                         Height - Bottom + 15, tick);
    }
    for (const double tick : y.ticks()) {
        const double at = y.to_pixels(tick);
        svg += formatted("<path class=\"grid\" d=\"M%g %.1f H%g\"/>", Left, at, Width - Right);
        svg += formatted("<text x=\"%g\" y=\"%.1f\" text-anchor=\"end\">%g</text>", Left - 5, at + 4, tick);
    }
    svg += formatted("<text x=\"%g\" y=\"%g\" text-anchor=\"middle\">", (Left + Width - Right) / 2,
                     Height - 10) +
           escaped(plot.x_label) + "</text>";
    svg += formatted("<text transform=\"translate(14 %g) rotate(-90)\" text-anchor=\"middle\">",
                     (Top + Height - Bottom) / 2) +
           escaped(plot.y_label) + "</text>";
    for (const PlotSeries& series : plot.series) {
        std::string line, dots;
        for (const auto& point : series.points) {
            if (!is_drawn(point)) continue;
            const double px = x.to_pixels(point.first), py = y.to_pixels(point.second);
            line += formatted("%s%.1f %.1f", line.empty() ? "M" : " L", px, py);
            dots += formatted("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"2.4\"/>", px, py);
        }
        if (line.empty()) continue;
        svg += "<g class=\"line\" stroke=\"" + series.color + "\" fill=\"" + series.color + "\"><title>" +
               escaped(series.name) + "</title><path fill=\"none\" d=\"" + line + "\"/>" + dots + "</g>";
    }
    return svg + "</svg>";
}

}  // namespace tessera::tools::bench
