#pragma once

#include <cstddef>
#include <string>

#include "mediator/base/error.h"

namespace tessera::edit {

// What is wrong with a line of a script. Used inside this library only.
class ScriptError : public Error {
  public:
    ScriptError(std::size_t column, const std::string& message)
        : Error(ErrorCode::InvalidInput, message), column_(column) {}
    ScriptError(std::size_t line, std::size_t column, const std::string& message)
        : Error(ErrorCode::InvalidInput, message), line_(line), column_(column) {}
    std::size_t line() const { return line_; }  // 0: the one that is being read
    std::size_t column() const { return column_; }

  private:
    std::size_t line_ = 0, column_;
};

}  // namespace tessera::edit
