#pragma once

#include <span>

#include "client/display_file/output_reader.h"

namespace tessera::display_file {

// Projectors that throw onto one named screen, and for which the file says nothing about soft edges, get
// weights from where their pictures overlap, and a lift when the screen names their `black`.
void blend_overlaps(std::span<ReadOutput> outputs, ReadContext& context);

}  // namespace tessera::display_file
