#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "client/edit/rehearsal.h"
#include "client/edit/target.h"

namespace tessera::edit {

// Runs the language of `tessera edit` (its manual: help.h) on a target. One thread.
class EditInterpreter {
  public:
    using Print = std::function<void(std::string_view)>;  // whole lines
    EditInterpreter(EditTarget& target, Print print) : target_(target), print_(std::move(print)) {}

    // A whole script: rehearsed first, then done. On failure nothing is changed: by a mistake in it nothing
    // was sent; when the target refused a part, what stood before was taken back, or the message says that it
    // was not. The message begins with "name:line:column: "; the code is InvalidInput for mistakes, else the
    // target's.
    Expected<void> run_script(const std::string& name, std::string_view text);

    // One line at a prompt; a transaction of its own unless 'begin' was typed. After a failure all is as
    // before it. The message begins with "column N: ".
    Expected<void> run_line(std::string_view line);

    bool is_in_transaction() const { return prompt_ && prompt_->is_open(); }
    bool has_quit() const { return has_quit_; }

    // What the next line will see: for completion.
    const scene::Scene& scene();

  private:
    struct Failure {
        std::size_t line = 0;
        Error error;
    };
    std::optional<Failure> play(const std::vector<Step>& steps);
    Rehearsal& prompt();

    EditTarget& target_;
    Print print_;
    std::optional<Rehearsal> prompt_;
    bool has_quit_ = false;
};

}  // namespace tessera::edit
