#pragma once

#include <filesystem>
#include <string_view>

#include "mediator/program/log.h"

namespace tessera::cli {

// When the process dies of a bug (SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, an uncaught exception), writes
// PROGRAM-crash-PID.txt: the build, the cause, the latest lines of the log and the stacks of all threads (with
// eu-stack of Debian's elfutils, if it is installed). Then the signal takes its usual course, core dump included.
// It lies next to the log file; without one, in `folder`, or in the folder of temporary files if that is empty.
// Call it once, on the main thread. Does nothing in builds with sanitizers, which have reports of their own.
void report_crashes(const LogSettings& log, const std::filesystem::path& folder);

// A line for the report; the latest 64 are kept, each up to 400 bytes. One thread at a time.
void remember_for_crash_report(std::string_view line);

}  // namespace tessera::cli
