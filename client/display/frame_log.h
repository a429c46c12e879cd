#pragma once

#include <cstdio>
#include <memory>
#include <string>

#include "mediator/base/ids.h"

namespace tessera::client_display {

// What was shown when, a JSON object a line: output, frame, epoch and version of the scene, at (when it was
// to be shown; 0 = at once), shown (when it was), bound (of the clock's offset to the master's), samples of a
// pixel. Times in ns of this machine's monotonic clock.
class FrameLog {
  public:
    FrameLog() = default;                        // tells nobody
    explicit FrameLog(const std::string& path);  // appends; throws Error{Io}

    struct Line {
        std::string output;
        std::uint64_t frame = 0;
        Version version;
        std::int64_t at = 0, shown = 0, bound = 0;
        std::uint64_t samples = 0;
    };
    void add(const Line& line);

  private:
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace tessera::client_display
