#pragma once

#include <string>

#include "master/peers/node_table.h"

namespace tessera::master {

// Could render the view, whatever version it holds; not one that has refused `version` for want of room.
bool suits(const NodeRecord& node, const view::View& view, Version version);
// Suits, and holds the version.
bool ready(const NodeRecord& node, const view::View& view, Version version);

// What keeps nodes from the view: the renderer, channels, room for the scene; each with its remedy or its
// reason and "; " at the end. Nothing when it is none of these.
std::string obstacles(const NodeTable& nodes, const view::View& view, Version version);

}  // namespace tessera::master
