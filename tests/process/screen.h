#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/process/real_cluster.h"

namespace tessera::test {

// A virtual X server of 640 x 480 pixels (Xvfb), and its screen contents.
class Screen {
  public:
    // Throws Error{NotFound} without Xvfb; the test fails if it does not start.
    explicit Screen(const TemporaryFolder& folder);
    ~Screen();
    Screen(const Screen&) = delete;
    Screen& operator=(const Screen&) = delete;

    std::string variable() const { return "DISPLAY=:" + number_; }
    // Red, green and blue bytes, rows from the top.
    std::vector<std::uint8_t> pixels(int x, int y, int width, int height) const;

    static constexpr int Width = 640, Height = 480;

  private:
    std::string frame_buffer_, number_;
    tools::ChildProcess server_;
};

}  // namespace tessera::test
