#pragma once

namespace tessera::cli {

// What was built: the short hash of the commit, with -dirty if files differ from it; "" if it is not known.
// Written by deploy/cmake/commit.cmake at every build.
extern const char* const Commit;

}  // namespace tessera::cli
