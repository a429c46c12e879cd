#include "client/tools/command.h"

#include <iostream>

#include "client/tools/interrupts.h"

namespace tessera::tools {

int report_error(std::string_view command, int code, std::string_view message) {
    std::cerr << "tessera " << command << ": " << message << "\n";
    return code;
}

int exit_code(ErrorCode code) {
    switch (code) {
        case ErrorCode::InvalidInput:
        case ErrorCode::NotFound:
            return ExitBadInput;
        case ErrorCode::Unavailable:  // it would still be waiting
            return Interrupts::requested() ? ExitInterrupted : cli::ExitUnavailable;
        case ErrorCode::OutOfMemory:
            return cli::ExitUnavailable;
        case ErrorCode::Refused:
            return cli::ExitRefused;
        case ErrorCode::Io:
            return ExitCannotWrite;
        case ErrorCode::Internal:
            break;
    }
    return ExitInternal;
}

}  // namespace tessera::tools
