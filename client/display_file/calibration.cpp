#include "client/display_file/calibration.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "client/display_file/mesh_file.h"
#include "client/display_file/pfm.h"

namespace tessera::display_file {

namespace {

std::string path_of(const std::string& name, const ReadContext& context) {
    return (std::filesystem::path(context.folder) / name).string();
}

template <class T>
T taken(Expected<T> loaded, const Section& section, const std::string& key) {
    if (!loaded) section.refuse(key, loaded.error().what());
    return std::move(*loaded);
}

LoadedGrid three_components(const std::string& path, const Section& section, const std::string& key) {
    LoadedGrid grid = taken(load_pfm(path), section, key);
    if (grid.components != 3)
        section.refuse(key, "'" + path + "' has one component; it must be a PFM of three (\"PF\")");
    return grid;
}

display::WarpMap on_nodes(const LoadedGrid& grid) {
    return {.columns = grid.columns, .rows = grid.rows, .nodes = display::Grid::Nodes::Centres, .points = {}};
}

// x, y, z as stored.
display::WarpMap pointed(const LoadedGrid& grid) {
    display::WarpMap points = on_nodes(grid);
    for (std::size_t i = 0; i + 2 < grid.values.size(); i += grid.components)
        points.points.emplace_back(grid.values[i], grid.values[i + 1], grid.values[i + 2]);
    return points;
}

// The points at u, v; NaN stays NaN.
display::WarpMap points_at_uv(const LoadedGrid& grid, const display::PointAt& point_at) {
    display::WarpMap points = on_nodes(grid);
    for (std::size_t i = 0; i + 1 < grid.values.size(); i += grid.components) {
        const float u = grid.values[i], v = grid.values[i + 1];
        points.points.push_back(std::isnan(u) || std::isnan(v)
                                    ? glm::dvec3(std::numeric_limits<double>::quiet_NaN())
                                    : point_at(u, v));
    }
    return points;
}

}  // namespace

display::Grid stored(const LoadedGrid& loaded, scene::BlobStore& blobs) {
    const auto bytes = std::as_bytes(std::span(loaded.values));
    return {.columns = loaded.columns,
            .rows = loaded.rows,
            .components = loaded.components,
            .nodes = display::Grid::Nodes::Centres,
            .values = scene::reference(*blobs.insert(bytes))};
}

display::WarpMap read_points(Section& section, const ReadContext& context) {
    const std::string path = path_of(section.text("points").value_or(""), context);
    return pointed(three_components(path, section, "points"));
}

display::WarpMap read_warp(Section& section, ReadContext& context, const display::Screen& screen,
                           display::Output& output) {
    const std::string path = path_of(section.text("warp").value_or(""), context);
    LoadedGrid uv;
    if (path.ends_with(".pfm")) {
        uv = three_components(path, section, "warp");
    } else {
        LoadedMesh mesh = taken(load_mesh(path, output.width, output.height), section, "warp");
        uv = std::move(mesh.source_uv);
        const bool is_even = std::ranges::all_of(mesh.weights.values, [](float w) { return w == 1.0f; });
        if (!is_even) output.blend.weights = stored(mesh.weights, context.blobs);
    }
    return points_at_uv(uv, [&](double u, double v) { return display::point(screen, u, v); });
}

bool read_light_files(Section& section, ReadContext& context, display::Output& output) {
    const auto read = [&](const char* key, display::Grid& grid) {
        const auto name = section.text(key);
        if (name) grid = stored(taken(load_weights(path_of(*name, context)), section, key), context.blobs);
        return name.has_value();
    };
    const bool has_weights = read("weights", output.blend.weights);
    const bool has_lift = read("lift", output.blend.lift);
    return has_weights || has_lift;
}

}  // namespace tessera::display_file
