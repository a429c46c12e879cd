#include "client/display_file/placement.h"

#include "client/display_file/output_keys.h"
#include "client/display_file/screens.h"
#include "mediator/base/nearest.h"
#include "mediator/display/projector.h"

namespace tessera::display_file {

namespace {

display::WarpMap corners(const display::Wall& wall, const display::Part& part) {
    display::WarpMap grid{.columns = 2, .rows = 2, .nodes = display::Grid::Nodes::Edges, .points = {}};
    for (const double v : {1.0 - part.top, 1.0 - part.bottom}) {
        for (const double u : {part.left, part.right}) grid.points.push_back(display::point(wall, u, v));
    }
    return grid;
}

}  // namespace

void find_screen(Section& section, const ReadContext& context, double aspect_ratio,
                 OutputGeometry& geometry) {
    if (section.kind("screen") == Value::Kind::Text) {
        geometry.screen = *section.text("screen");
        const auto found = context.screens.find(geometry.screen);
        if (found == context.screens.end()) {
            std::vector<std::string> names;
            for (const auto& [name, screen] : context.screens) names.push_back(name);
            const auto meant = nearest(geometry.screen, names);
            section.refuse("screen", "there is no [[screen]] '" + geometry.screen + "'" +
                                         (meant ? "; did you mean '" + *meant + "'?" : ""));
        }
        geometry.surface = found->second.surface;
    } else if (auto own = section.section("screen")) {
        geometry.surface = read_screen(*own, aspect_ratio);
        own->refuse_unknown();
    } else {
        geometry.surface = read_screen(section, aspect_ratio);
    }
}

void lay_flat(const display::Wall& wall, const display::Part& part, ReadOutput& read) {
    const Pixels size = picture_size(read.output);
    read.output.plane = display::projection_plane(wall, part);
    read.output.view_width = size.width;
    read.output.view_height = size.height;
    read.geometry.points = corners(wall, part);
}

void lay_out(ReadOutput& read, ReadContext& context) {
    display::Output& output = read.output;
    if (output.turn != display::Turn::None)
        read.section.refuse("turn",
                            "has points or a warp and 'turn': these are of the device's own pixels, "
                            "so they hold the turn already; leave 'turn' out");
    const display::WarpMap& grid = read.geometry.points;
    if (read.geometry.surface && std::holds_alternative<display::Wall>(*read.geometry.surface)) {
        // One plane for all outputs on it.
        output.plane = display::projection_plane(std::get<display::Wall>(*read.geometry.surface));
        output.plane.hull = display::hull(grid);
    } else {
        output.plane = display::projection_plane(grid, context.head.position);
    }
    const display::Size size =
        display::view_size(grid, output.plane, context.head.position, output.width, output.height);
    output.view_width = size.width;
    output.view_height = size.height;
    std::vector<float> values;
    values.reserve(grid.points.size() * 3);
    for (const glm::dvec3& point : grid.points) {
        for (int axis = 0; axis < 3; ++axis) values.push_back(float(point[axis]));
    }
    output.points = {.columns = grid.columns,
                     .rows = grid.rows,
                     .components = 3,
                     .nodes = grid.nodes,
                     .values = scene::reference(*context.blobs.insert(std::as_bytes(std::span(values))))};
}

display::WarpMap projected_points(const view::CameraPose& projector, const display::Screen& screen,
                                  const display::Output& output) {
    const glm::dvec3 lens(projector.world_from_camera[3]);
    const auto point_at = [&](double u, double v) {
        const auto point = display::hit(screen, lens, display::ray(projector, u, v));
        if (!point)
            throw Error(ErrorCode::InvalidInput,
                        "a pixel of the projector does not meet the screen: turn it towards the screen");
        return *point;
    };
    return display::sample(point_at, output.width, output.height);
}

}  // namespace tessera::display_file
