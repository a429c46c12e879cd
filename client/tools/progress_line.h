#pragma once

#include <string>

#include "mediator/session/view_summary.h"

namespace tessera::tools {

// What the line says, without the terminal: "42 %   27 of 64 spp   8.1 Mrays/s   12 s left".
std::string describe(const session::ViewProgress& progress, const session::ViewRequest& request);

// One line on standard error that is written over again and again; nothing at all when that is no terminal.
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
