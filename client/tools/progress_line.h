#pragma once

#include <string>

#include "mediator/session/view_summary.h"

namespace tessera::tools {

// The text of the progress line: "42 %   27 of 64 spp   8.1 Mrays/s   12 s left".
std::string describe(const session::ViewProgress& progress, const session::ViewRequest& request);

// A progress line on standard error, overwritten in place; prints nothing if that is not a terminal.
class ProgressLine {
  public:
    ProgressLine();
    ~ProgressLine();  // clears it

    void show(const std::string& text);

  private:
    bool is_terminal_;
    bool is_shown_ = false;
};

}  // namespace tessera::tools
