#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "mediator/base/error.h"
#include "mediator/program/command_line.h"

namespace tessera::tools {

// Exit codes that every command shares; those of wrong options and absent clusters are in mediator/program/command_line.h.
inline constexpr int ExitComparison = 1;
inline constexpr int ExitBadInput = 2;
inline constexpr int ExitInternal = 70;
inline constexpr int ExitCannotWrite = 74;
inline constexpr int ExitInterrupted = 130;

// One sub-command of `tessera`: it has put its options on the command line, and runs when it is chosen.
struct Command {
    std::string name;
    std::function<int(std::string_view chosen)> run;  // `chosen`: with words of its own, as "keys add"
};

// Says on standard error what went wrong, under the command's name; returns the code.
int complain(std::string_view command, int code, std::string_view message);
int exit_code(ErrorCode code);

}  // namespace tessera::tools
