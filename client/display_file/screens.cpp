#include "client/display_file/screens.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tessera::display_file {

namespace {

constexpr double Degree = std::numbers::pi / 180.0;
constexpr double StandardFov = 50.0, StandardDistance = 0.7;
constexpr double LeastLength = 1e-4, MostLength = 1e5;  // metres

constexpr std::array CornerKeys{"lower_left", "lower_right", "upper_left", "upper_right"};

bool has_corners(const Section& section) {
    return std::ranges::any_of(CornerKeys, [&](const char* key) { return section.has(key); });
}

glm::dvec3 corner(Section& section, const std::string& key) {
    const auto position = section.point(key);
    if (!position) section.require(key);
    return *position;
}

double needed(Section& section, const std::string& key, double least, double most) {
    const auto number = section.number(key, least, most);
    if (!number) section.require(key);
    return *number;
}

// `from` < `to`, in radians, of two keys in degrees.
std::array<double, 2> angles(Section& section, const std::string& from, const std::string& to, double least,
                             double most) {
    const double begin = needed(section, from, least, most), end = needed(section, to, least, most);
    if (!(end > begin)) section.refuse(to, "'" + to + "' must be greater than '" + from + "'");
    return {begin * Degree, end * Degree};
}

display::Cylinder read_cylinder(Section section) {
    const auto [from, to] = angles(section, "from", "to", -360.0, 360.0);
    display::Cylinder cylinder{.centre = section.point("centre").value_or(glm::dvec3(0.0)),
                               .radius = needed(section, "radius", LeastLength, MostLength),
                               .from = from,
                               .to = to,
                               .bottom = needed(section, "bottom", -MostLength, MostLength),
                               .top = needed(section, "top", -MostLength, MostLength)};
    if (!(cylinder.top > cylinder.bottom)) section.refuse("top", "'top' must be above 'bottom'");
    section.refuse_unknown();
    return cylinder;
}

display::Dome read_dome(Section section) {
    const auto [from, to] = angles(section, "from", "to", -360.0, 360.0);
    const auto [bottom, top] = angles(section, "bottom", "top", -90.0, 90.0);
    const display::Dome dome{.centre = section.point("centre").value_or(glm::dvec3(0.0)),
                             .radius = needed(section, "radius", LeastLength, MostLength),
                             .from = from,
                             .to = to,
                             .bottom = bottom,
                             .top = top,
                             .tilt = section.number("tilt", -180.0, 180.0).value_or(0.0) * Degree};
    section.refuse_unknown();
    return dome;
}

}  // namespace

bool has_screen(const Section& section) {
    return has_corners(section) || section.has("fov") || section.has("distance") || section.has("cylinder") ||
           section.has("dome");
}

display::Wall read_wall(Section& section) {
    const glm::dvec3 lower_left = corner(section, CornerKeys[0]);
    const glm::dvec3 lower_right = corner(section, CornerKeys[1]);
    const glm::dvec3 upper_left = corner(section, CornerKeys[2]);
    const auto upper_right = section.point(CornerKeys[3]);
    try {
        return display::wall(lower_left, lower_right, upper_left, upper_right);
    } catch (const Error& error) {
        section.refuse(CornerKeys[0], error.what());
    }
}

display::Screen read_screen(Section& section, double aspect_ratio) {
    section.knows({CornerKeys[0], CornerKeys[1], CornerKeys[2], CornerKeys[3], "fov", "distance"});
    const int kinds = int(has_corners(section)) + int(section.has("fov") || section.has("distance")) +
                      int(section.has("cylinder")) + int(section.has("dome"));
    if (kinds > 1)
        section.refuse(
            "has several kinds of screen: give corners, or fov and distance, or cylinder, or dome");
    if (has_corners(section)) return read_wall(section);
    if (const auto cylinder = section.section("cylinder")) return read_cylinder(*cylinder);
    if (const auto dome = section.section("dome")) return read_dome(*dome);
    return display::wall_in_view(
        section.number("fov", 0.01, 170.0).value_or(StandardFov) * Degree, aspect_ratio,
        section.number("distance", LeastLength, MostLength).value_or(StandardDistance));
}

view::CameraPose read_projector(Section& section, double aspect_ratio) {
    display::Projector projector;
    projector.position = corner(section, "position");
    projector.look_at = corner(section, "look_at");
    projector.up = section.direction("up").value_or(projector.up);
    projector.shift = section.pair("shift", -2.0, 2.0).value_or(projector.shift);
    const auto fov = section.number("fov", 0.1, 170.0);
    const auto ratio = section.number("throw", 0.05, 100.0);
    if (fov && ratio) section.refuse("throw", "has both 'fov' and 'throw': give one of them");
    if (!fov && !ratio) section.refuse("needs 'throw' (distance / width of the picture) or 'fov' (degrees)");
    projector.horizontal_fov = fov ? *fov * Degree : 2.0 * std::atan(0.5 / *ratio);
    section.refuse_unknown();
    try {
        return display::pose(projector, aspect_ratio);
    } catch (const Error& error) {
        section.refuse(error.what());
    }
}

}  // namespace tessera::display_file
