#include "client/tools/edit.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <vector>

#include "client/edit/interpreter.h"
#include "client/edit/prompt.h"

namespace tessera::tools {

namespace {

constexpr const char* EditName = "edit";

struct EditOptions {
    std::optional<std::string> script;
    std::vector<std::string> commands;
    SceneAddress address{.master = {}, .keys = {}, .user = "editor", .name = "editor", .title = "scene"};
};

int report(const Error& error) {
    return complain(EditName,
                    error.code() == ErrorCode::InvalidInput ? ExitBadScript : exit_code(error.code()),
                    error.what());
}

void print(std::string_view text) {
    std::cout << text << std::flush;
}

Expected<std::string> read_script(const std::string& name) {
    std::error_code unreadable;
    std::ifstream file;
    if (name != "-") {
        if (std::filesystem::is_directory(name, unreadable)) {
            return failure(ErrorCode::NotFound, "'" + name + "' is a folder: name a script");
        }
        file.open(name, std::ios::binary);
        if (!file)
            return failure(ErrorCode::NotFound,
                           "there is no script '" + name + "' that can be read: check the name");
    }
    std::istream& stream = name == "-" ? std::cin : file;
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (stream.bad()) return failure(ErrorCode::Io, "'" + name + "' cannot be read");
    return text;
}

// Each option -c is a line of one script.
std::string joined(const std::vector<std::string>& commands) {
    std::string text;
    for (const std::string& command : commands) text += command + "\n";
    return text;
}

int run_script(edit::EditTarget& target, const std::string& name, const std::string& text) {
    edit::EditInterpreter interpreter(target, print);
    const auto done = interpreter.run_script(name, text);
    return done ? 0 : report(done.error());
}

int run_prompt(edit::EditTarget& target) {
    edit::EditInterpreter interpreter(target, print);
    edit::Prompt prompt(stdin, stdout, edit::usual_history_file(),
                        [&](std::string_view text, std::size_t cursor) {
                            return edit::complete(text, cursor, interpreter.scene());
                        });
    std::cout << "'help' explains the language, Tab completes, Ctrl-D leaves.\n";
    while (!interpreter.has_quit()) {
        const auto line = prompt.read(interpreter.is_in_transaction() ? "tessera (begun)> " : "tessera> ");
        if (!line) {
            std::cout << "\n";
            break;
        }
        if (const auto done = interpreter.run_line(*line); !done) std::cerr << done.error().what() << "\n";
    }
    if (interpreter.is_in_transaction())
        std::cerr << "the transaction was not committed: nothing of it was sent\n";
    return 0;
}

int run(const EditOptions& options, const ConnectScene& connect) {
    if (options.script && !options.commands.empty()) {
        return complain(EditName, cli::ExitUsage, "a script and -c do not go together: choose one");
    }
    const bool is_typed = !options.script && options.commands.empty() && ::isatty(STDIN_FILENO) != 0;
    const std::string name = !options.commands.empty() ? "-c" : options.script.value_or("-");
    try {
        std::string text = joined(options.commands);
        if (!is_typed && options.commands.empty()) {
            auto script = read_script(name);
            if (!script) return complain(EditName, exit_code(script.error().code()), script.error().what());
            text = std::move(*script);
        }
        const std::unique_ptr<edit::EditTarget> target = connect(options.address);
        return is_typed ? run_prompt(*target) : run_script(*target, name, text);
    } catch (const Error& error) {
        return complain(EditName, exit_code(error.code()), error.what());
    }
}

}  // namespace

Command edit_command(cli::CommandLine& program, ConnectScene connect) {
    const auto options = std::make_shared<EditOptions>();
    cli::CommandLine& command = program.command(
        EditName, "Edit a live scene: by a script, single commands, or at a prompt ('help' there).");
    command.optional_positional("SCRIPT", "file with one command a line, - for a pipe; without one a prompt",
                                options->script);
    command.option("-c",
                   "a command, in place of a script; may be given several times, all are one transaction",
                   options->commands);
    command.option("--master", "where the cluster is: tcp://host:port", options->address.master);
    command.option("--keys", "keys for that cluster: a folder, or an exported file", options->address.keys);
    command.option("--user", "whose pair in a folder of keys", options->address.user);
    command.option("--name", "your name, for the others", options->address.name);
    command.option("--scene", "title of the scene that is started when there is none",
                   options->address.title);
    command.required("--master");
    command.examples({"tessera edit --master tcp://render-1:7420 --keys ~/.tessera",
                      "tessera edit tour.txt --master tcp://127.0.0.1:7420",
                      "tessera edit --master tcp://127.0.0.1:7420 -c 'load room.glb' -c 'save copy.tessera'",
                      "tessera edit --master tcp://127.0.0.1:7420 -c 'help all'"});
    return {EditName,
            [options, connect = std::move(connect)](std::string_view) { return run(*options, connect); }};
}

}  // namespace tessera::tools
