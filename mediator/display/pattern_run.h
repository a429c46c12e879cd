#pragma once

#include <tbb/task_arena.h>

#include <cstdint>
#include <span>

#include "mediator/display/output_pipeline.h"

namespace tessera::display {

// The test pattern as the output's device shows it, for the display's head. `devices` as of
// OutputPipeline::run.
void run_pattern(tbb::task_arena& arena, OutputPipeline& pipeline, const Output& output,
                 const Display& display, std::span<const std::span<std::uint8_t>> devices);

}  // namespace tessera::display
