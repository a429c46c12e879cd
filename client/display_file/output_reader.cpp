#include "client/display_file/output_reader.h"

#include <algorithm>

#include "client/cli/cli.h"
#include "client/display_file/calibration.h"
#include "client/display_file/output_keys.h"
#include "client/display_file/screens.h"
#include "mediator/display/projector.h"

namespace tessera::display_file {

namespace {

constexpr std::uint64_t MaxBentPixels = std::uint64_t{1} << 25;  // 8K; each may get a point, 12 bytes

// The named screen, or one that the output has for itself.
void find_screen(Section& section, const ReadContext& context, double aspect_ratio,
                 OutputGeometry& geometry) {
    if (section.kind("screen") == Value::Kind::Text) {
        geometry.screen = *section.text("screen");
        const auto found = context.screens.find(geometry.screen);
        if (found == context.screens.end()) {
            std::vector<std::string> names;
            for (const auto& [name, screen] : context.screens) names.push_back(name);
            const auto meant = cli::nearest(geometry.screen, names);
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

display::PointGrid corners(const display::Wall& wall, const display::Part& part) {
    display::PointGrid grid{.columns = 2, .rows = 2, .nodes = display::Grid::Nodes::Edges, .points = {}};
    for (const double v : {1.0 - part.top, 1.0 - part.bottom}) {
        for (const double u : {part.left, part.right}) grid.points.push_back(display::point(wall, u, v));
    }
    return grid;
}

// The picture's pixels are seen at the points of the geometry.
void lay_out(ReadOutput& read, ReadContext& context) {
    display::Output& output = read.output;
    if (output.turn != display::Turn::None)
        read.section.refuse("turn",
                            "has points or a warp and 'turn': these are of the device's own pixels, "
                            "so they hold the turn already; leave 'turn' out");
    const display::PointGrid& grid = read.geometry.points;
    if (read.geometry.surface && std::holds_alternative<display::Wall>(*read.geometry.surface)) {
        // One plane for all outputs on it.
        output.plane = display::view_plane(std::get<display::Wall>(*read.geometry.surface));
        output.plane.hull = display::hull(grid);
    } else {
        output.plane = display::view_plane(grid, context.head.position);
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

display::PointGrid thrown(const view::CameraPose& projector, const display::Screen& screen,
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

void place(ReadOutput& read, ReadContext& context) {
    Section& section = read.section;
    display::Output& output = read.output;
    OutputGeometry& geometry = read.geometry;
    const Pixels size = picture_size(output);
    const double aspect_ratio = double(size.width) / size.height;
    if (int(section.has("points")) + int(section.has("warp")) + int(section.has("projector")) > 1)
        section.refuse(
            "has several of 'points', 'warp' and 'projector': each says where its pixels are seen");
    section.knows({"points", "warp"});
    if (section.has("points")) {
        if (has_screen(section) || section.has("screen"))
            section.refuse("points", "has 'points' and a screen: points say where the screen is");
        geometry.points = read_points(section, context);
        return lay_out(read, context);
    }
    find_screen(section, context, aspect_ratio, geometry);
    const display::Screen& screen = *geometry.surface;
    const auto* wall = std::get_if<display::Wall>(&screen);
    auto projector = section.section("projector");
    if (wall && !projector && !section.has("warp")) return lay_flat(*wall, {}, read);
    if (std::uint64_t{output.width} * output.height > MaxBentPixels)
        section.refuse("size", "is bent and has more than 33 megapixels: split the output");
    if (projector) {
        geometry.projector = read_projector(*projector, aspect_ratio);
        geometry.points = thrown(*geometry.projector, screen, output);
    } else if (section.has("warp")) {
        geometry.points = read_warp(section, context, screen, output);
    } else {
        geometry.points = display::sample([&](double u, double v) { return display::point(screen, u, v); },
                                          size.width, size.height);
    }
    lay_out(read, context);
}

}  // namespace

std::string read_name(Section& section, const char* what) {
    const auto name = section.text("name");
    if (!name) section.require("name");
    // Names become files of pictures and words of command lines.
    const auto is_fine = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
               c == '_' || c == '.';
    };
    if (name->empty() || name->size() > 64 || !std::ranges::all_of(*name, is_fine) || name->front() == '.' ||
        name->front() == '-')
        section.refuse("name", "'name' must be letters, digits, '-', '_' and '.', at most 64");
    section.call(std::string(what) + " '" + *name + "'");
    return *name;
}

void lay_flat(const display::Wall& wall, const display::Part& part, ReadOutput& read) {
    const Pixels size = picture_size(read.output);
    read.output.plane = display::view_plane(wall, part);
    read.output.view_width = size.width;
    read.output.view_height = size.height;
    read.geometry.points = corners(wall, part);
}

ReadOutput read_output(Section section, ReadContext& context) {
    ReadOutput read{.output = {}, .geometry = {}, .section = section};
    Section& keys = read.section;
    display::Output& output = read.output;
    output.name = read_name(keys, "output");
    if (const auto size = keys.size("size")) {
        output.width = (*size)[0];
        output.height = (*size)[1];
    }
    read.has_own_blend = keys.has("blend");
    read_output_keys(keys, output);
    try {
        place(read, context);
        read.has_own_blend = read_light_files(keys, context, output) || read.has_own_blend;
    } catch (const Error& error) {
        if (std::string_view(error.what()).starts_with(keys.file() + ":")) throw;
        keys.refuse(error.what());
    }
    if (const auto view = keys.size("view")) {
        output.view_width = (*view)[0];
        output.view_height = (*view)[1];
    }
    keys.refuse_unknown();
    return read;
}

}  // namespace tessera::display_file
