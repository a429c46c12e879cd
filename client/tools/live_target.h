#pragma once

#include <memory>

#include "client/tools/edit.h"

namespace tessera::tools {

// Joins a live scene on a master, as the target of edit commands. Throws Error.
std::unique_ptr<edit::EditTarget> connect_scene(const SceneAddress& address);

}  // namespace tessera::tools
