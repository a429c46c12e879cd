#pragma once

#include <functional>
#include <memory>
#include <string>

#include "client/edit/target.h"
#include "client/tools/command.h"

namespace tessera::tools {

// The live scene to join, and the identity of this client.
struct SceneAddress {
    std::string master, keys, user;
    std::string name;   // of this member, as others see it
    std::string title;  // of the scene, if a new one is opened
};

// Joins the scene; throws Error.
using ConnectScene = std::function<std::unique_ptr<edit::EditTarget>(const SceneAddress&)>;

inline constexpr int ExitBadScript = 65;

// `tessera edit`: edits a live scene with commands from a file, a pipe or a prompt.
Command edit_command(cli::CommandLine& program, ConnectScene connect);

}  // namespace tessera::tools
