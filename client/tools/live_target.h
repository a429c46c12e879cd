#pragma once

#include <memory>

#include "client/tools/edit.h"

namespace tessera::tools {

// A live scene on a master as what the edit language works on. Throws Error.
std::unique_ptr<edit::EditTarget> connect_scene(const SceneAddress& address);

}  // namespace tessera::tools
