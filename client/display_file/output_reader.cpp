#include "client/display_file/output_reader.h"

#include <algorithm>

#include "client/display_file/calibration.h"
#include "client/display_file/output_keys.h"
#include "client/display_file/placement.h"
#include "client/display_file/screens.h"

namespace tessera::display_file {

namespace {

constexpr std::uint64_t MaxWarpedPixels = std::uint64_t{1} << 25;  // 8K; each may need a point of 12 bytes

void locate_pixels(ReadOutput& read, ReadContext& context) {
    Section& section = read.section;
    display::Output& output = read.output;
    OutputGeometry& geometry = read.geometry;
    const Pixels size = picture_size(output);
    const double aspect_ratio = double(size.width) / size.height;
    if (int(section.has("points")) + int(section.has("warp")) + int(section.has("projector")) > 1)
        section.refuse(
            "has several of 'points', 'warp' and 'projector': each defines where its pixels are seen; give "
            "one of them");
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
    if (std::uint64_t{output.width} * output.height > MaxWarpedPixels)
        section.refuse("size", "is warped and has more than 33 megapixels: split the output");
    if (projector) {
        geometry.projector = read_projector(*projector, aspect_ratio);
        geometry.points = projected_points(*geometry.projector, screen, output);
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
    // Names are used in file names and command lines.
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
        locate_pixels(read, context);
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
