#pragma once

#include <functional>
#include <memory>
#include <string>

#include "client/edit/target.h"
#include "client/tools/command.h"

namespace tessera::tools {

// Which live scene, and who comes.
struct SceneAddress {
    std::string master, keys, user;
    std::string name;   // of this member, for the others
    std::string title;  // of a scene that is started when there is none
};

// Joins the scene; throws Error.
using ConnectScene = std::function<std::unique_ptr<edit::EditTarget>(const SceneAddress&)>;

inline constexpr int ExitBadScript = 65;

// `tessera edit`: a live scene by the text language, from a file, a pipe or a prompt.
Command edit_command(cli::CommandLine& program, ConnectScene connect);

}  // namespace tessera::tools
