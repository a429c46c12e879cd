#include "client/display_file/output_keys.h"
#include "client/display_file/output_reader.h"
#include "client/display_file/placement.h"
#include "client/display_file/screens.h"
#include "mediator/display/wall_grid.h"

namespace tessera::display_file {

namespace {

// Maps soft edges of the picture to the edges of the mounted device.
void set_ramps(double left, double right, double top, double bottom, display::Output& output) {
    display::Blend& blend = output.blend;
    const auto set = [&](double l, double r, double t, double b) {
        blend.left = l;
        blend.right = r;
        blend.top = t;
        blend.bottom = b;
    };
    switch (output.turn) {
        case display::Turn::None:
            return set(left, right, top, bottom);
        case display::Turn::Quarter:  // the device's top edge is on the right
            return set(top, bottom, right, left);
        case display::Turn::Half:
            return set(right, left, bottom, top);
        case display::Turn::ThreeQuarters:
            return set(bottom, top, left, right);
    }
}

}  // namespace

std::vector<ReadOutput> read_wall_outputs(Section section) {
    const std::string name = read_name(section, "wall");
    const display::Wall wall = read_wall(section);
    display::Output pattern;
    if (const auto size = section.size("size")) {
        pattern.width = (*size)[0];
        pattern.height = (*size)[1];
    }
    read_output_keys(section, pattern);
    const Pixels picture = picture_size(pattern);
    display::WallGrid grid{.width = picture.width, .height = picture.height};
    grid.columns = std::uint32_t(section.whole("columns", 1, 64).value_or(1));
    grid.rows = std::uint32_t(section.whole("rows", 1, 64).value_or(1));
    if (grid.columns * grid.rows > display::MaxOutputs) {
        section.refuse("columns", "has " + std::to_string(grid.columns * grid.rows) +
                                      " outputs; a display has at most " +
                                      std::to_string(display::MaxOutputs));
    }
    if (const auto bezel = section.pair("bezel", 0.0, 10.0)) {
        grid.bezel_across = bezel->x;
        grid.bezel_upward = bezel->y;
    }
    if (const auto overlap = section.counts("overlap", 0, display::MaxEdge)) {
        grid.overlap_across = (*overlap)[0];
        grid.overlap_upward = (*overlap)[1];
    }
    const auto view = section.size("view");
    const auto desktop = section.counts("desktop", 1, 64).value_or(std::array{1u, 1u});
    section.refuse_unknown();

    std::vector<display::Part> parts;
    try {
        parts = display::parts(wall, grid);
    } catch (const Error& error) {
        section.refuse(error.what());
    }
    const bool has_ramps = !section.has("blend");
    std::vector<ReadOutput> outputs;
    for (std::uint32_t i = 0; i < parts.size(); ++i) {
        const std::uint32_t column = i % grid.columns, row = i / grid.columns;
        ReadOutput read{.output = pattern, .geometry = {}, .section = section};
        read.output.name = name + "-" + std::to_string(column + 1) + "-" + std::to_string(row + 1);
        read.section.call("output '" + read.output.name + "'");
        read.output.x = pattern.x + std::int32_t(column % desktop[0] * pattern.width);
        read.output.y = pattern.y + std::int32_t(row % desktop[1] * pattern.height);
        read.geometry.screen = name;
        read.geometry.surface = wall;
        lay_flat(wall, parts[i], read);
        if (view) {
            read.output.view_width = (*view)[0];
            read.output.view_height = (*view)[1];
        }
        if (has_ramps) {
            const double across = grid.overlap_across, upward = grid.overlap_upward;
            set_ramps(column > 0 ? across : 0.0, column + 1 < grid.columns ? across : 0.0,
                      row > 0 ? upward : 0.0, row + 1 < grid.rows ? upward : 0.0, read.output);
        }
        outputs.push_back(std::move(read));
    }
    return outputs;
}

}  // namespace tessera::display_file
