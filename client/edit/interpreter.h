#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "client/edit/dry_run.h"
#include "client/edit/target.h"

namespace tessera::edit {

// Runs the language of `tessera edit` (its manual: help.h) on a target. One thread.
class EditInterpreter {
  public:
    using Print = std::function<void(std::string_view)>;  // whole lines
    EditInterpreter(EditTarget& target, Print print) : target_(target), print_(std::move(print)) {}

    // Runs a whole script: a dry run first, then execution. A script with mistakes sends nothing. If the target rejects
    // a transaction, the earlier ones are undone, or the message says why they could not be. The message begins with
    // "name:line:column: "; the code is InvalidInput for mistakes, else that of the target.
    Expected<void> run_script(const std::string& name, std::string_view text);

    // Runs one line typed at a prompt, as a separate transaction unless 'begin' was typed. A failed line changes
    // nothing. The message begins with "column N: ".
    Expected<void> run_line(std::string_view line);

    bool is_in_transaction() const { return prompt_ && prompt_->is_open(); }
    bool has_quit() const { return has_quit_; }

    // The scene that the next line will see, for completion.
    const scene::Scene& scene();

  private:
    struct Failure {
        std::size_t line = 0;
        Error error;
    };
    std::optional<Failure> execute(const std::vector<Step>& steps);
    DryRun& prompt();

    EditTarget& target_;
    Print print_;
    std::optional<DryRun> prompt_;
    bool has_quit_ = false;
};

}  // namespace tessera::edit
