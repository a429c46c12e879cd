#pragma once

#include <cstdio>
#include <memory>
#include <string>

#include "mediator/base/ids.h"

namespace tessera::client_display {

// Log of presented frames, one JSON object per line: output, frame, epoch and version of the scene, at (scheduled time;
// 0 = immediately), shown (actual time), bound (of the clock offset to the master), samples per pixel. Times in ns of
// the local monotonic clock.
class FrameLog {
  public:
    FrameLog() = default;                        // logs nothing
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
