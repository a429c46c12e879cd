#pragma once

#include <string>

#include "mediator/base/error.h"

namespace tessera::import {

// For readers that give up in the middle: whoever called them turns it into a result or into a report.
[[noreturn]] inline void reject(const std::string& cause) {
    throw Error(ErrorCode::InvalidInput, cause);
}

}  // namespace tessera::import
