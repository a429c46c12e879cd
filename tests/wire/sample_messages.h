#pragma once

#include <vector>

#include "mediator/wire/messages.h"

namespace tessera::wire {

// Messages of all kinds of a link, with values that are easily lost.
std::vector<ControlMessage> control_messages();
std::vector<BulkMessage> bulk_messages();

view::View some_view();
// With objects of most kinds, and entries of all.
scene::ChangeList some_changes();

}  // namespace tessera::wire
