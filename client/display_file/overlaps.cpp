#include "client/display_file/overlaps.h"

#include <algorithm>

#include "client/display_file/calibration.h"
#include "mediator/display/overlap.h"

namespace tessera::display_file {

namespace {

LoadedGrid on_pixels(std::vector<float> values, const display::Output& output) {
    return {.columns = output.width, .rows = output.height, .components = 1, .values = std::move(values)};
}

}  // namespace

void blend_overlaps(std::span<ReadOutput> outputs, ReadContext& context) {
    for (const auto& [name, screen] : context.screens) {
        std::vector<ReadOutput*> projectors;
        std::vector<display::ProjectorOutput> projector_outputs;
        for (ReadOutput& read : outputs) {
            if (read.geometry.screen != name || !read.geometry.projector || read.has_own_blend) continue;
            projectors.push_back(&read);
            projector_outputs.push_back({.projector = *read.geometry.projector,
                                         .points = read.geometry.points,
                                         .width = read.output.width,
                                         .height = read.output.height});
        }
        if (projectors.size() < 2) continue;
        tbb::task_arena arena;
        std::vector<display::OverlapMaps> maps = display::overlap(projector_outputs, screen.black, arena);
        for (std::size_t i = 0; i < maps.size(); ++i) {
            display::Output& output = projectors[i]->output;
            const bool is_alone = std::ranges::all_of(maps[i].weights, [](float w) { return w == 1.0f; });
            if (!is_alone)
                output.blend.weights = stored(on_pixels(std::move(maps[i].weights), output), context.blobs);
            if (!maps[i].lift.empty())
                output.blend.lift = stored(on_pixels(std::move(maps[i].lift), output), context.blobs);
        }
    }
}

}  // namespace tessera::display_file
