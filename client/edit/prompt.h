#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "client/edit/completion.h"

namespace tessera::edit {

// $XDG_STATE_HOME/tessera/edit_history, or below ~/.local/state; empty when there is no home.
std::filesystem::path default_history_file();

// Lines typed at a terminal, with editing, completion by Tab and a history in a file (readable by its owner only;
// I/O errors are ignored). While a line is typed, Ctrl-C is a key like any
// other and clears it: no signal is involved. Takes the characters of the environment's locale. One thread.
class Prompt {
  public:
    using Complete = std::function<Completion(std::string_view text, std::size_t cursor)>;
    Prompt(std::FILE* in, std::FILE* out, std::filesystem::path history_file, Complete complete);
    ~Prompt();
    Prompt(const Prompt&) = delete;
    Prompt& operator=(const Prompt&) = delete;

    // Nothing at the end of the input, that is Ctrl-D on an empty line. "" for a line that was cleared.
    std::optional<std::string> read(const std::string& prompt);

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace tessera::edit
