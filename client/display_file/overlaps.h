#pragma once

#include <span>

#include "client/display_file/output_reader.h"

namespace tessera::display_file {

// Computes blend weights from the overlaps of projectors that share a named screen and have no soft edges in the file,
// and a lift when the screen has `black`.
void blend_overlaps(std::span<ReadOutput> outputs, ReadContext& context);

}  // namespace tessera::display_file
