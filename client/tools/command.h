#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "mediator/base/error.h"
#include "mediator/program/command_line.h"

namespace tessera::tools {

// Exit codes shared by all commands; see also mediator/program/command_line.h.
inline constexpr int ExitComparison = 1;
inline constexpr int ExitBadInput = 2;
inline constexpr int ExitIncomplete = 3;  // written, but for tiles that no node could render
inline constexpr int ExitInternal = 70;
inline constexpr int ExitCannotWrite = 74;
inline constexpr int ExitInterrupted = 130;

// One sub-command of `tessera`: its options are already registered; `run` is called when it is chosen.
struct Command {
    std::string name;
    std::function<int(std::string_view chosen)>
        run;  // `chosen`: including nested sub-commands, as "display open"
};

// Prints "tessera COMMAND: MESSAGE" to standard error; returns the code.
int report_error(std::string_view command, int code, std::string_view message);
int exit_code(ErrorCode code);

}  // namespace tessera::tools
