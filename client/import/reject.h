#pragma once

#include <string>

#include "mediator/base/error.h"

namespace tessera::import {

// Ends a reader; its caller turns the error into a result or a notice.
[[noreturn]] inline void reject(const std::string& cause) {
    throw Error(ErrorCode::InvalidInput, cause);
}

}  // namespace tessera::import
