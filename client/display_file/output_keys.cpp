#include "client/display_file/output_keys.h"

#include <utility>

namespace tessera::display_file {

namespace {

using display::Stereo;

constexpr std::array<std::string_view, 9> StereoWords{
    "mono", "left", "right", "separate", "side-by-side", "top-bottom", "rows", "anaglyph-plain", "anaglyph"};
constexpr std::array StereoModes{Stereo::Mono,           Stereo::Left,          Stereo::Right,
                                 Stereo::Separate,       Stereo::SideBySide,    Stereo::TopBottom,
                                 Stereo::InterlacedRows, Stereo::AnaglyphPlain, Stereo::AnaglyphDubois};

// One number for all three, or three.
glm::dvec3 read_gain(Section& section) {
    constexpr double Most = 100.0;
    if (section.kind("gain") != Value::Kind::List)
        return glm::dvec3(section.number("gain", 0.0, Most).value_or(1.0));
    const auto values = section.numbers("gain", 0.0, Most);
    if (values->size() != 3) section.refuse("gain", "'gain' must be one number or three: [red, green, blue]");
    return {(*values)[0], (*values)[1], (*values)[2]};
}

display::Color read_color(Section section) {
    display::Color color;
    if (const auto rows = section.numbers("matrix", -100.0, 100.0)) {
        if (rows->size() != 9) section.refuse("matrix", "'matrix' must be nine numbers, row by row");
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column)
                color.matrix[column][row] = (*rows)[std::size_t(3 * row + column)];
        }
    }
    color.gain = read_gain(section);
    color.gamma = section.number("gamma", 0.5, 5.0).value_or(0.0);
    if (const auto curve = section.numbers("curve", 0.0, 1.0)) {
        if (color.gamma != 0.0) section.refuse("curve", "has both 'gamma' and 'curve': give one of them");
        if (curve->size() < 2 || curve->size() > display::MaxCurve)
            section.refuse("curve", "'curve' must have from 2 to " + std::to_string(display::MaxCurve) +
                                        " values: device values for light from 0 to 1");
        color.curve.assign(curve->begin(), curve->end());
    }
    section.refuse_unknown();
    return color;
}

void read_blend(Section section, display::Blend& blend) {
    const std::array<std::pair<const char*, double*>, 4> edges{
        {{"left", &blend.left}, {"right", &blend.right}, {"top", &blend.top}, {"bottom", &blend.bottom}}};
    for (const auto& [key, value] : edges)
        *value = section.number(key, 0.0, display::MaxEdge).value_or(*value);
    blend.shape = section.number("shape", 0.1, 10.0).value_or(blend.shape);
    section.refuse_unknown();
}

}  // namespace

void read_output_keys(Section& section, display::Output& output) {
    constexpr std::int64_t Farthest = 1 << 20;
    output.x = std::int32_t(section.whole("x", -Farthest, Farthest).value_or(output.x));
    output.y = std::int32_t(section.whole("y", -Farthest, Farthest).value_or(output.y));
    if (const auto index = section.choice("stereo", StereoWords)) output.stereo = StereoModes[*index];
    if (const auto turn = section.whole("turn", 0, 270)) {
        if (*turn % 90 != 0) section.refuse("turn", "'turn' must be 0, 90, 180 or 270 (degrees clockwise)");
        output.turn = static_cast<display::Turn>(*turn / 90);
    }
    if (const auto priority = section.whole("priority", 1, 8)) {
        if (*priority != 1 && *priority != 2 && *priority != 4 && *priority != 8)
            section.refuse("priority", "'priority' must be 1, 2, 4 or 8: samples relative to other outputs");
        output.priority = std::uint32_t(*priority);
    }
    if (const auto blend = section.section("blend")) read_blend(*blend, output.blend);
    if (const auto color = section.section("color")) output.color = read_color(*color);
}

Pixels picture_size(const display::Output& output) {
    const bool is_on_its_side =
        output.turn == display::Turn::Quarter || output.turn == display::Turn::ThreeQuarters;
    return is_on_its_side ? Pixels{output.height, output.width} : Pixels{output.width, output.height};
}

}  // namespace tessera::display_file
