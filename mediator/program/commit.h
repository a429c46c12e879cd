#pragma once

namespace tessera::cli {

// The commit of the build: its short hash, with -dirty if files differ from it; "" if unknown.
// Written by deploy/cmake/commit.cmake at every build.
extern const char* const Commit;

}  // namespace tessera::cli
