#pragma once

#include <stdexcept>
#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace tessera {

enum class ErrorCode {
    InvalidInput,  // a file, message or option is wrong; the same input fails again
    NotFound,      // a named object, file or key does not exist
    Unavailable,   // temporary: a peer is not connected, a resource is busy
    Refused,       // rejected by the peer or a rule
    Io,            // the operating system failed to read or write
    OutOfMemory,
    Internal,  // a bug: a broken invariant
};

// The exception of all components. The message is a lower-case phrase that names object, cause and remedy.
class Error : public std::runtime_error {
  public:
    Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ErrorCode code() const { return code_; }

  private:
    ErrorCode code_;
};

// An expected outcome: a value, or why there is none.
template <class T>
using Expected = tl::expected<T, Error>;

inline tl::unexpected<Error> failure(ErrorCode code, std::string message) {
    return tl::unexpected<Error>(Error(code, std::move(message)));
}

}  // namespace tessera
