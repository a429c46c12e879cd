#include "mediator/display/validate.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "mediator/base/error.h"
#include "mediator/display/frustum.h"

namespace tessera::display {

namespace {

// Of all eyes of an output together: they are queued for one output client.
constexpr std::uint64_t MaxPictureBytes = std::uint64_t{200} << 20;
constexpr std::size_t MaxViews = 128;

bool is_within(double value, double least, double most) {
    return value >= least && value <= most;
}

void check_grid(const Grid& grid, std::uint32_t components, const std::string& what,
                std::vector<std::string>& found) {
    if (grid.empty()) return;
    const std::uint64_t bytes = std::uint64_t{4} * grid.columns * grid.rows * grid.components;
    if (grid.components != components || grid.columns < 2 || grid.rows < 2 || grid.columns > MaxEdge ||
        grid.rows > MaxEdge || grid.values.byte_size != bytes)
        found.push_back(what + " must be a grid of " + std::to_string(components) +
                        " components: create it again");
}

void check_output(const Display& display, const Output& output, std::vector<std::string>& found) {
    const std::string name = "output '" + output.name + "'";
    const auto bad = [&](const std::string& text) { found.push_back(name + ": " + text); };
    if (output.name.empty() || output.name.size() > 64) bad("a name has 1 to 64 bytes");
    for (const auto& [edge, what] : {std::pair(output.width, "width"), std::pair(output.height, "height"),
                                     std::pair(output.view_width, "width of its view"),
                                     std::pair(output.view_height, "height of its view")}) {
        if (edge < 1 || edge > MaxEdge) bad(std::string("its ") + what + " is not within 1 and 16384 pixels");
    }
    const std::uint64_t bytes =
        std::uint64_t{6} * output.view_width * output.view_height * eyes(output.stereo).size();
    if (bytes > MaxPictureBytes) bad("its pictures are larger than 200 MiB: split it into several outputs");
    if (output.priority != 1 && output.priority != 2 && output.priority != 4 && output.priority != 8)
        bad("its priority is not 1, 2, 4 or 8");
    if (!output.points.empty() && output.stereo == Stereo::InterlacedRows)
        bad("interlaced rows cannot be warped: remove the warp or choose another stereo mode");
    if (!output.points.empty() && output.turn != Turn::None)
        bad("it has both a turn and a warp: leave the turn out, the warp includes it");
    check_grid(output.points, 3, name + ": its points", found);
    check_grid(output.blend.weights, 1, name + ": its weights", found);
    check_grid(output.blend.lift, 1, name + ": its black-level lift", found);
    const Blend& blend = output.blend;
    for (const double edge : {blend.left, blend.right, blend.top, blend.bottom}) {
        if (!is_within(edge, 0.0, MaxEdge)) bad("a soft edge is not within 0 and 16384 pixels");
    }
    if (!is_within(blend.shape, 0.1, 10.0)) bad("the shape of its soft edges is not within 0.1 and 10");
    const Color& color = output.color;
    if (color.gamma != 0.0 && !is_within(color.gamma, 0.5, 5.0)) bad("its gamma is not within 0.5 and 5");
    if (color.curve.size() == 1) bad("its curve has one point: give two or more");
    for (const float value : color.curve) {
        if (!is_within(value, 0.0, 1.0)) bad("its curve has values not within 0 and 1");
    }
    for (int i = 0; i < 3; ++i) {
        if (!is_within(color.gain[i], 0.0, 100.0)) bad("its gain is not within 0 and 100");
        for (int j = 0; j < 3; ++j) {
            if (!is_within(color.matrix[i][j], -100.0, 100.0))
                bad("its colour matrix has numbers not within -100 and 100");
        }
    }
    const ProjectionPlane& plane = output.plane;
    constexpr double Tolerance = 1e-6;
    if (!(std::abs(glm::length(plane.right) - 1.0) < Tolerance) ||
        !(std::abs(glm::length(plane.up) - 1.0) < Tolerance) ||
        !(std::abs(glm::dot(plane.right, plane.up)) < Tolerance))
        bad("the axes of its projection plane are not unit and orthogonal");
    if (plane.hull.size() < 3) return bad("its projection plane has fewer than three points");
    try {
        for (const view::Eye eye : eyes(output.stereo))
            (void)frustum(plane, display.head, eye, display.eye_separation, display.zero_parallax);
    } catch (const Error& error) {
        bad(error.what());
    }
}

}  // namespace

std::vector<std::string> problems(const Display& display) {
    std::vector<std::string> found;
    if (display.name.size() > 64) found.emplace_back("the display's name is longer than 64 bytes");
    if (display.outputs.empty()) found.emplace_back("the display has no outputs: add one");
    if (display.outputs.size() > MaxOutputs) found.emplace_back("the display has more than 64 outputs");
    if (display.layers.size() > MaxLayers) found.emplace_back("the display has more than 4 layers");
    if (!display.layers.empty() && std::ranges::none_of(display.layers, &Layer::shown))
        found.emplace_back("no layer of the display is shown: show one of them");
    if (!is_within(display.units_per_metre, 1e-9, 1e9))
        found.emplace_back("units_per_metre is not within 1e-9 and 1e9");
    if (!has_valid_position(display.head))
        found.emplace_back("the head is more than 1000 km away: check its unit");
    if (!is_within(display.eye_separation, 0.0, 10.0))
        found.emplace_back("the eye separation is not within 0 and 10 m");
    if (!is_within(display.zero_parallax, 0.0, 1e6))
        found.emplace_back("the distance without parallax is not within 0 and 1e6 m");
    if (!is_within(display.rate, 0.1, 1000.0)) found.emplace_back("the rate is not within 0.1 and 1000 Hz");
    if (!is_within(display.exposure, -60.0, 60.0))
        found.emplace_back("the exposure is not within -60 and 60 EV");
    if (display.white != 0.0 && !is_within(display.white, 1e-3, 1e6))
        found.emplace_back("white is neither 0 nor within 0.001 and 1e6");
    if (display.spp < 1 || display.spp > (std::uint64_t{1} << 24))
        found.emplace_back("spp is not within 1 and 2^24");
    if (display.coarsest != 1 && display.coarsest != 2 && display.coarsest != 4 && display.coarsest != 8)
        found.emplace_back("coarsest is not 1, 2, 4 or 8");
    std::set<std::string> names;
    std::size_t views = 0;
    for (const Output& output : display.outputs) {
        if (!names.insert(output.name).second)
            found.push_back("two outputs have the name '" + output.name + "': rename one");
        check_output(display, output, found);
        views += eyes(output.stereo).size() * std::max<std::size_t>(1, display.layers.size());
    }
    if (views > MaxViews)
        found.push_back("the display has " + std::to_string(views) +
                        " views, more than 128: fewer outputs, eyes or layers");
    return found;
}

}  // namespace tessera::display
