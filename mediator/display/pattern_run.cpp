#include "mediator/display/pattern_run.h"

#include <glm/gtc/packing.hpp>
#include <vector>

#include "mediator/display/frustum.h"
#include "mediator/display/pattern.h"

namespace tessera::display {

void run_pattern(tbb::task_arena& arena, OutputPipeline& pipeline, const Output& output,
                 const Display& display, std::span<const std::span<std::uint8_t>> devices) {
    std::vector<std::vector<std::uint16_t>> light;
    std::vector<EyePicture> pictures;
    for (const view::Eye eye : eyes(output.stereo)) {
        if (!output.points.empty()) {
            pipeline.set_frustum(eye, screen_pose(output.plane, display.head, eye, display.eye_separation,
                                                  display.zero_parallax));
        }
        std::vector<std::uint16_t>& values = light.emplace_back();
        for (const float value : pattern(output, eye).values) values.push_back(glm::packHalf1x16(value));
    }
    for (const std::vector<std::uint16_t>& values : light) {
        pictures.push_back({.width = output.view_width,
                            .height = output.view_height,
                            .values = std::as_bytes(std::span(values))});
    }
    pipeline.run(arena, pictures, devices);
}

}  // namespace tessera::display
