# Writes the file OUTPUT with the commit of SOURCE, if it has changed; "" if it is unknown.
# Usage: cmake -D SOURCE=folder -D OUTPUT=file -P commit.cmake
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --exclude=*
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[#include "mediator/program/commit.h"

namespace tessera::cli {

const char* const Commit = "@commit@";

}  // namespace tessera::cli
]])
