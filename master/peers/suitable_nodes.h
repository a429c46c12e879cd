#pragma once

#include <string>

#include "master/peers/node_table.h"

namespace tessera::master {

// Whether the node could render the view, at any version; false if it has refused `version`.
bool suits(const NodeRecord& node, const view::View& view, Version version);
// Suitable, and has built the version.
bool ready(const NodeRecord& node, const view::View& view, Version version);

// Why no node can render the view: renderer, channels or a refusal of the scene, each with its remedy or reason and
// a final "; ". Empty if it is none of these.
std::string obstacles(const NodeTable& nodes, const view::View& view, Version version);

}  // namespace tessera::master
